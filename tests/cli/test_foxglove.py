"""`kickctl foxglove` as a person starts and ends it."""

import asyncio
import json
import signal
import subprocess
import sys

import pytest

from host.commands import foxglove
from host.foxglove.server import Viewers
from host.logs.messages import EVENTS, TICKS
from host.util.installation import install_command
from tests.foxglove.viewer import viewer_of
from tests.lint.sources import ROOT


@pytest.mark.parametrize(
    ("arguments", "message", "hint"),
    [
        (("--control", "--listen", "192.0.2.1"), "works on this computer only", "ssh -L"),
        (("--unattended", "stop"), "robots that are driven", "--control"),
        (("--force",), "--force is for --layout", "leave it out"),
        (("--listen", "everybody"), "cannot be 'everybody'", ""),
        (("--brick", "tcp://127.0.0.1:1", "--seed", "1"), "is only for the robot", "has the seed"),
    ],
)
def test_what_makes_no_sense_is_refused_in_words(kickctl, arguments, message, hint):
    status, out, _ = kickctl("foxglove", "--json", *arguments)
    error = json.loads(out)["error"]
    assert status == 2
    assert message in error["message"]
    assert hint in error["hint"]


def test_without_the_extra_it_says_how_to_get_it(kickctl, monkeypatch):
    monkeypatch.setitem(sys.modules, "foxglove", None)
    status, out, _ = kickctl("foxglove", "--json")
    error = json.loads(out)["error"]
    assert (status, error["message"]) == (2, "this needs foxglove, which is not installed")
    assert error["hint"] == f"install it: {install_command('foxglove')}"


def test_the_layout_is_a_file_that_is_not_replaced_unasked(kickctl, tmp_path):
    path = tmp_path / "kick.json"
    line = ("foxglove", "--layout", str(path), "--brick", "tcp://127.0.0.1:1")
    assert kickctl(*line)[0] == 0
    first = path.read_text()
    assert "/ticks.left_x1" in first
    assert "CallService" not in first
    assert kickctl(*line, "--control")[0] == 2
    assert path.read_text() == first
    assert kickctl(*line, "--control", "--force")[0] == 0
    assert "CallService" in path.read_text()


def test_it_serves_a_simulated_robot_until_it_is_interrupted():
    line = ["-m", "host", "foxglove", "--json", "--port", "0", "--control", "--seed", "1"]
    with subprocess.Popen(
        [sys.executable, *line],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            info = json.loads(process.stdout.readline())

            async def scenario():
                async with viewer_of(info["url"], services=7) as viewer:
                    await viewer.subscribe(TICKS, EVENTS)
                    await viewer.until(lambda: len(viewer.of(TICKS)) > 3)
                    await viewer.call("/unlock", {"key": info["key"]})
                    await viewer.call("/kick", {"mode": "phase"})
                    await viewer.until(lambda: viewer.of(EVENTS))

            asyncio.run(scenario())
            assert [one["unattended"] for one in info["robots"]] == ["continue"]
            process.send_signal(signal.SIGINT)
            assert process.wait(60.0) == 0
            assert "Traceback" not in process.stderr.read()
        finally:
            process.kill()


def test_a_terminal_reads_where_to_connect_and_with_which_key(kickctl, monkeypatch):
    """It looks about until the first look is interrupted."""

    def look(self):
        raise KeyboardInterrupt

    monkeypatch.setattr(Viewers, "look", look)
    monkeypatch.setattr(foxglove, "station_of", lambda *_: _Nobody())
    status, out, err = kickctl("foxglove", "--port", "0", "--control")
    connect, key = out.splitlines()
    assert status == 0
    assert connect.startswith("connect ws://127.0.0.1:")
    assert len(key.split()[1]) == 22
    assert "Foxglove WebSocket" in err
    assert "key" not in kickctl("foxglove", "--port", "0")[1]


class _Nobody:
    name = "anna"
    uri = "tcp://127.0.0.1:1"
    rule = "stop"
