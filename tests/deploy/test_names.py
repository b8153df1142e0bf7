"""A robot gets a name on this machine: by being deployed, and by being found."""

import json
import subprocess
import sys

import pytest

from host.cli import main
from host.link import discovery
from host.link.discovery import Found
from robot.hardware import hardware_id
from tests.deploy.brick import ROOT, needs_sshd


@needs_sshd
def test_a_deployed_robot_has_a_name_and_a_token_of_its_own(brick, checkout, tmp_path):
    environment = checkout.environment(
        PYTHONPATH=str(ROOT),
        KICK_ROBOT_ARGS=f"--sysfs {brick.sysfs} --host 127.0.0.1 --port 0 --seed 5",
    )
    del environment["KICK_TOKEN"]

    def run(*arguments):
        done = subprocess.run(
            [sys.executable, "-m", "host", *arguments],
            env=environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=100,
            check=False,
        )
        return done.returncode, done.stdout + done.stderr

    status, output = run("deploy", "--as", "anna", "brick")
    assert status == 0, output
    assert "The robot is known here as anna" in output
    assert "--brick anna start" in output or "--brick anna clear" in output
    token = tmp_path / "config" / "kickctl" / "tokens" / "anna"
    assert token.stat().st_mode & 0o777 == 0o600
    known = json.loads(run("robots", "list", "--json")[1])["robots"]
    assert known == {
        "anna": {"address": brick.uri(), "token": str(token), "hardware_id": hardware_id() or None}
    }
    status, output = run("--brick", "anna", "params", "set", "k=7")
    assert status == 0, output
    assert "k = 7" in output
    # It keeps name and token when it is deployed to again, and another brick must not take them.
    assert f"copy the token {token}" in run("deploy", "--dry-run", "brick")[1]
    other = token.with_name("other-local")
    assert f"copy the token {other}" in run("deploy", "--dry-run", "other-local")[1]
    status, output = run("deploy", "--as", "all", "brick")
    assert (status, "cannot be named 'all'" in output) == (2, True)


def test_what_was_found_gets_names_once(monkeypatch, capsys):
    found = [
        Found("ev3dev", "robot", "tcp://10.0.0.1", "ev3dev.local", ("10.0.0.1",)),
        Found("ev3dev", "robot", "tcp://10.0.0.2", "ev3dev-2.local", ("10.0.0.2",)),
        Found("a brick", "EV3 brick", "ssh://robot@10.0.0.3", "a.local", ("10.0.0.3",)),
    ]
    monkeypatch.setattr(discovery, "look_around", lambda seconds: found)
    assert main(["robots", "add", "mine", "ssh://robot@10.0.0.2"]) == 0
    capsys.readouterr()
    assert main(["discover", "--save", "--json"]) == 0
    saved = {"ev3dev": "tcp://10.0.0.1", "a-brick": "ssh://robot@10.0.0.3"}
    assert json.loads(capsys.readouterr().out)["saved"] == saved
    assert main(["discover", "--save"]) == 0
    assert "all of them have names already" in capsys.readouterr().out
    assert main(["discover"]) == 0
    assert main(["robots", "list"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 6


@pytest.mark.parametrize(
    ("text", "name"),
    [("ev3dev.local", "ev3dev"), ("10.0.0.1", "10-0-0-1"), ("", "robot"), ("all", "robot")],
)
def test_a_name_is_made_of_any_text(text, name):
    from host.link.robots_file import free_name

    assert free_name(text, ()) == name
    assert free_name(text, (name, f"{name}-2")) == f"{name}-3"
