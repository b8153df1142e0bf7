"""The lights and the back button."""

import os

import pytest

from robot.button import BACK, EVENT, KEY, PRESSED, BackButton
from robot.lights import LEFT_AND_RIGHT, Lights
from robot.record import STATES
from tests.rig import Rig

LEDS = (
    "led0:red:brick-status",
    "led0:green:brick-status",
    "led1:red:brick-status",
    "led1:green:brick-status",
)


@pytest.fixture
def rig():
    return Rig()


@pytest.fixture
def sysfs(tmp_path):
    for name in LEDS:
        (tmp_path / "leds" / name).mkdir(parents=True)
    return tmp_path


def shown(sysfs):
    """Brightness of left red, left green, right red, right green."""
    return [
        int((sysfs / "leds" / name / "brightness").read_text(encoding="ascii")) for name in LEDS
    ]


def test_every_state_looks_different(rig, sysfs):
    lights = Lights(str(sysfs))
    looks = []
    for state in range(len(STATES)):
        rig.loop.safety.state = state
        lights.serve(rig.loop)
        looks.append(tuple(shown(sysfs)))
    assert len(set(looks)) == len(STATES) == len(LEFT_AND_RIGHT)
    assert looks[STATES.index("running")] == (0, 255, 0, 255)
    assert looks[STATES.index("fault")] == (255, 0, 255, 0)
    lights.close()
    assert shown(sysfs) == [0, 0, 0, 0]


def test_the_lights_are_written_only_when_the_state_changes(rig, sysfs):
    lights = Lights(str(sysfs))
    lights.serve(rig.loop)
    (sysfs / "leds" / "led0:red:brick-status" / "brightness").write_text("7", encoding="ascii")
    lights.serve(rig.loop)
    assert shown(sysfs)[0] == 7


def test_a_brick_without_lights_does_without(rig, tmp_path):
    lights = Lights(str(tmp_path))
    lights.serve(rig.loop)
    lights.close()


@pytest.fixture
def device(tmp_path):
    """What a button is to a program: a file to read events from."""
    path = tmp_path / "event0"
    os.mkfifo(path)
    return path


@pytest.fixture
def pressing(device):
    """The button, and a function that sends it events as (type, code, value)."""
    button = BackButton(str(device))
    end = os.open(device, os.O_WRONLY)
    yield (
        button,
        lambda *events: os.write(end, b"".join(EVENT.pack(1, 2, *event) for event in events)),
    )
    os.close(end)
    button.close()


def test_pressing_back_stops_the_robot(rig, pressing):
    button, press = pressing
    rig.loop.start()
    rig.run(3)
    button.serve(rig.loop)
    assert STATES[rig.loop.safety.state] == "running"
    press((KEY, 28, PRESSED), (0, 0, 0), (KEY, BACK, PRESSED), (0, 0, 0))
    button.serve(rig.loop)
    assert STATES[rig.loop.safety.state] == "stopped"
    assert "back button" in rig.loop.safety.reason
    assert rig.duties == (0, 0)


@pytest.mark.parametrize("event", [(KEY, 28, PRESSED), (KEY, BACK, 0), (2, BACK, PRESSED)])
def test_nothing_else_stops_it(rig, pressing, event):
    button, press = pressing
    rig.loop.start()
    press(event)
    button.serve(rig.loop)
    assert STATES[rig.loop.safety.state] == "running"


def test_an_event_is_as_long_as_this_machines_kernel_has_it():
    assert EVENT.size == 2 * (8 if os.sys.maxsize > 2**32 else 4) + 8


def test_a_brick_without_that_button_does_without(rig, tmp_path):
    button = BackButton(str(tmp_path / "none"))
    button.serve(rig.loop)
    button.close()
