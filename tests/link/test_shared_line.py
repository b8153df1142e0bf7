"""Two programs at one serial line: one sets it up and reads it, and anyone may stop the robot."""

import subprocess
import sys
import termios
from pathlib import Path

import pytest

from host.client.robot import Robot
from host.client.stop import stop_robot
from host.errors import NoLink
from host.link.addresses import make_link
from robot.record import STATES
from tests.link.machines import Cable, Machine
from tests.rig import TOKEN

PATIENCE_S = 30.0
# Another kickctl: it records until its standard input ends, and says what it has missed.
RECORDER = """
import sys, threading
from host.client.robot import Robot
from host.link.addresses import make_link
ended = threading.Event()
threading.Thread(target=lambda: (sys.stdin.read(), ended.set()), daemon=True).start()
with Robot(make_link(sys.argv[1]), None, "recorder") as robot, robot.recording() as log:
    robot.wait(0.1)
    print("recording", flush=True)
    robot.wait(1e9, ended.is_set)
    robot.wait(0.3)
print(log.missing(), [event["event"] for event in log.events])
"""


@pytest.fixture
def line(tmp_path):
    """A machine, its line's address, and the device file."""
    cable = Cable(tmp_path)
    machine = Machine(cable.paths["robot"])
    yield machine, f"serial://{cable.paths['host']}", str(cable.paths["host"])
    machine.close()
    cable.close()


@pytest.fixture
def recorder(line):
    """Another program that records over the line."""
    process = subprocess.Popen(
        [sys.executable, "-c", RECORDER, line[1]],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout.readline() == "recording\n"
    yield process
    process.kill()
    process.communicate()


def test_a_second_opener_learns_who_has_the_line(line, recorder):
    with pytest.raises(NoLink) as error:
        Robot(make_link(line[1]), TOKEN)
    assert f"(process {recorder.pid}) has it open" in error.value.message
    assert "python" in error.value.message
    assert recorder.communicate("", PATIENCE_S)[0] == "[] ['snapshot']\n"


def test_a_stop_joins_the_line_and_leaves_the_recording_whole(line, recorder):
    """It uses the line as the other has set it up, also when it was given another baud rate."""
    machine, uri, device = line
    before = _settings(device)
    assert stop_robot(make_link(uri + "?baud=9600"), patience_s=PATIENCE_S).state == "stopped"
    assert STATES[machine.loop.safety.state] == "stopped"
    assert _settings(device) == before
    missed = recorder.communicate("", PATIENCE_S)[0]
    assert missed == "[] ['snapshot', 'stop']\n"


def test_a_line_that_a_foreign_program_keeps_for_itself_is_told(line, monkeypatch):
    _, uri, _ = line

    def refuse(path, flags):
        raise OSError(16, "Device or resource busy")

    monkeypatch.setattr("os.open", refuse)
    with pytest.raises(NoLink, match=r"motors may still be running: .* keeps the line for itself"):
        stop_robot(make_link(uri))


def _settings(device):
    with Path(device).open("rb", buffering=0) as file:
        return termios.tcgetattr(file)
