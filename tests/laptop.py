"""A laptop of somebody who has robots: a folder with their names and tokens, and kickctl there."""

import json
import os
import subprocess
import sys
from contextlib import contextmanager

from tests.lint.sources import ROOT
from tests.small_figures import without_figures

# A program that drives a robot until somebody takes over, and then tries to go on.
DRIVER = """
import logging
from kickctl import KickctlError, connect

logging.basicConfig(format="%(message)s")
with connect({name!r}, name={driver!r}) as robot:
    robot.lease()
    print("drives", flush=True)
    robot.wait(float("inf"), until=lambda: not robot.drives)
    try:
        robot.kick("phase")
    except KickctlError as error:
        print(error, flush=True)
"""


class Laptop:
    """A user's folder with names and tokens of robots, and kickctl there.

    Figures can be drawn if it `draws`, which takes a second each. `more` is what the user's
    environment has besides.
    """

    def __init__(self, folder, *, draws=True, **more):
        self.folder = folder
        self.draws = draws
        self._more = more
        self.config = folder / "config" / "kickctl"
        folder.mkdir(exist_ok=True)

    def knows(self, name, address, token=None):
        """Write a robot into the file of robots."""
        self.config.mkdir(parents=True, exist_ok=True)
        more = "" if token is None else f'token = "{token}"\n'
        with (self.config / "robots.toml").open("a", encoding="utf-8") as file:
            file.write(f'[{name}]\naddress = "{address}"\n{more}')

    def environment(self, **more):
        kept = {key: value for key, value in os.environ.items() if not key.startswith("KICK_")}
        path = str(ROOT) if self.draws else without_figures(self.folder)
        own = {"XDG_CONFIG_HOME": str(self.folder / "config"), "PYTHONPATH": path}
        return {**kept, **own, **self._more, **more}

    def run(self, *arguments, **more):
        """Run kickctl: (exit status, standard output, standard error)."""
        done = subprocess.run(
            [sys.executable, "-m", "host", *arguments],
            env=self.environment(**more),
            cwd=self.folder,
            capture_output=True,
            text=True,
            timeout=100,
            check=False,
        )
        return done.returncode, done.stdout, done.stderr

    @contextmanager
    def driving(self, name, driver):
        """A program that has the lease of a robot; what it says is on its standard output."""
        with subprocess.Popen(
            [sys.executable, "-c", DRIVER.format(name=name, driver=driver)],
            env=self.environment(),
            cwd=self.folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        ) as process:
            try:
                begin = process.stdout.readline()
                assert begin == "drives\n", begin + process.communicate(timeout=60)[0]
                yield process
            finally:
                process.kill()

    def each(self, *arguments, **more):
        """Run kickctl with --json on several robots: (exit status, {name: result})."""
        status, out, err = self.run(*arguments, "--json", **more)
        assert out, err
        return status, json.loads(out)["robots"]
