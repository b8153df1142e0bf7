"""kickctl from the wheel, in an environment of its own, run from an empty folder."""

import json
import os
import re
import subprocess

import pytest

from tests.deploy.brick import Brick, needs_sshd, write
from tests.package.conftest import succeed

# All of these on one worker, as each worker would build the packages again.
pytestmark = pytest.mark.xdist_group("package")


@pytest.fixture
def run(installed, tmp_path):
    """Run a program of the environment in an empty folder: its standard output."""

    def run(program, *arguments, **environment):
        path = f"{installed}:{os.environ['PATH']}"
        cache = str(installed.parent / "cache")  # what one test has compiled serves the next
        environment |= {"PATH": path, "PYTHONPATH": "", "XDG_CACHE_HOME": cache}
        return succeed(installed / program, *arguments, cwd=tmp_path, **environment)

    return run


def test_it_runs_from_the_wheel_and_not_from_the_checkout(run, installed):
    for package in ("kickctl", "host", "robot", "sim_motor"):
        file = run("python", "-c", f"import {package}; print({package}.__file__)")
        assert file.startswith(str(installed.parent))


def test_a_kick_reverses_the_simulated_robot(run):
    outcome = json.loads(run("kickctl", "kick", "--mode", "phase", "--ticks", "4", "--json"))
    assert outcome["reversed"]


def test_the_import_name_for_people_works(run, installed):
    file = run("python", "-c", "import kickctl; print(kickctl.connect, kickctl.__file__)")
    assert str(installed.parent) in file


def test_the_robots_program_and_the_robot_on_the_desk_say_what_they_take(run):
    for module in ("robot", "sim_motor"):
        assert "--token" in run("python", "-m", module, "--help")


def test_results_are_kept_and_a_second_run_resumes(run, tmp_path):
    command = ("kickctl", "experiment", "timeline", "--trials", "1", "--seed", "3", "--json")
    command += ("--format", "svg")
    first = json.loads(run(*command))
    logs = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.mcap")}
    assert logs
    assert json.loads(run(*command)) == first
    assert {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.mcap")} == logs


def test_deploy_sends_the_robot_of_the_package(run):
    assert "--rollback" in run("kickctl", "deploy", "--help")
    shown = run("kickctl", "deploy", "--dry-run")
    assert "robot/service/brick.sh" in shown
    assert "robot/loop.py" in shown


def test_the_release_has_the_same_name_from_the_package_and_from_the_checkout(run, source):
    (ours,) = succeed(source / "deploy.sh", "--dry-run", cwd=source).splitlines()[:1]
    assert run("kickctl", "deploy", "--dry-run").splitlines()[0] == ours


def test_doctor_finds_all_libraries_and_hints_name_commands_that_exist(run, installed, tmp_path):
    findings = json.loads(run("kickctl", "doctor", "--json"))["findings"]
    found = {finding["what"]: finding["found"] for finding in findings}
    assert found["libraries"] == "all there"
    assert {"extra bodies", "extra cluster", "extra gym"} <= set(found)
    done = subprocess.run(
        [installed / "kickctl", "--brick", "tcp://127.0.0.1:1", "status"],
        cwd=tmp_path,
        env={**os.environ, "PATH": f"{installed}:{os.environ['PATH']}", "PYTHONPATH": ""},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 3
    assert "kickctl deploy --logs" in done.stderr
    assert "deploy.sh" not in done.stderr


@needs_sshd
def test_deploy_brings_the_robot_of_the_package_to_a_brick(run, tmp_path):
    brick = Brick(tmp_path)
    write(brick.sysfs / "power_supply" / "lego-ev3-battery" / "technology", "Li-ion\n")
    brick.boot()
    try:
        shown = run(
            "kickctl",
            *("deploy", "brick"),
            KICK_SSH_OPTIONS=f"-F {brick.ssh_config}",
            KICK_TOKEN=str(tmp_path / "token"),
            KICK_ROBOT_ARGS=f"--sysfs {brick.sysfs} --host 127.0.0.1 --port 0",
        )
        assert brick.runs() == brick.release()
    finally:
        brick.shut_down()
    # With the settings that this command had, as typed by hand.
    # Its name, by which it is known now, stands for its address and its token.
    own = "KICK_SSH_OPTIONS=.+"
    assert re.search(rf"\n  {own} kickctl --brick brick start\n", shown), shown
