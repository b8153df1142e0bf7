"""docs/own-motors.md: its blocks run as they are written, but for the port, which must be free."""

import os
import re
import select
import socket
import subprocess
import sys
from pathlib import Path

from host.logs.log import Log
from tests.lint.sources import ROOT

PATIENCE_S = 100.0
PAGE = (ROOT / "docs" / "own-motors.md").read_text(encoding="utf-8")
TOY = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)[0]
START, KICK = re.findall(r"```sh\n(.*?)```", PAGE, re.DOTALL)[:2]


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return str(probe.getsockname()[1])


def test_an_empty_file_becomes_a_kicked_robot(tmp_path):
    assert len(TOY.splitlines()) <= 40
    Path("toy.py").write_text(TOY, encoding="utf-8")
    port = free_port()
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path}
    start = START.replace("5430", port).split()
    assert start[0] == "python"
    with subprocess.Popen(
        [sys.executable, *start[1:]],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as robot:
        try:
            assert select.select([robot.stdout], (), (), PATIENCE_S)[0]
            assert robot.stdout.readline().startswith("READY tcp://")
            done = subprocess.run(
                ["sh", "-ec", KICK.replace("5430", port)],
                env=environment,
                capture_output=True,
                text=True,
                timeout=PATIENCE_S,
                check=False,
            )
            assert done.returncode == 0, done.stdout + done.stderr
            assert "The kick reversed the robot: a phase kick" in done.stdout
        finally:
            robot.terminate()
            robot.wait(PATIENCE_S)
        said = robot.stderr.read()
    assert "the watchdog cannot stop the left and the right motor" in said
    assert "Traceback" not in said
    (path,) = tmp_path.glob("logs/*-kick-*.mcap")
    log = Log.load(path)
    ((begin, _),) = log.kicks()
    # The reversal is in the angles too, which the toy alone makes.
    for side in ("left", "right"):
        angles = log.column(side + "_phi_rad")
        before, after = angles[begin] - angles[begin - 15], angles[-1] - angles[-16]
        assert before * after < -4.0
