"""The lights, the speaker and the back button."""

import os

import pytest

from robot.beacon import LASTS_S, PERIOD_S, Announcer
from robot.button import BACK, EVENT, KEY, PRESSED, BackButton
from robot.lights import LEFT_AND_RIGHT, Lights
from robot.record import STATES
from robot.speaker import SOUND, TONE, TONE_HZ, Speaker
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
        (tmp_path / "leds" / name / "brightness").write_text("0", encoding="ascii")
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


def test_lights_that_the_watchdog_has_made_red_show_the_state_again(rig, sysfs):
    lights = Lights(str(sysfs))
    lights.serve(rig.loop)
    idle = shown(sysfs)
    Lights(str(sysfs)).alarm()  # as in the watchdog's process
    assert shown(sysfs) == [255, 0, 255, 0]
    lights.forget()
    lights.serve(rig.loop)
    assert shown(sysfs) == idle


def test_a_brick_without_lights_does_without(rig, tmp_path):
    lights = Lights(str(tmp_path))
    lights.serve(rig.loop)
    assert lights.ways == ()
    lights.close()


def test_lights_blink_while_the_robot_shows_itself_and_then_show_its_state(rig, sysfs):
    lights = Lights(str(sysfs))
    assert lights.ways == ("lights",)
    rig.loop.start()
    rig.run(1)
    begin = rig.clock.time
    assert rig.loop.beacon.begin("'anna'", begin) == LASTS_S
    green, dark, looks = [0, 255, 0, 255], [0, 0, 0, 0], []
    while rig.clock.time < begin + LASTS_S + 1.0:
        lights.serve(rig.loop)
        if [shown(sysfs)] != looks[-1:]:
            looks.append(shown(sysfs))
        rig.run(1)
    assert looks == [green, dark] * round(LASTS_S / PERIOD_S) + [green]
    lights.close()


def test_no_file_is_opened_while_lights_are_served(rig, sysfs, monkeypatch):
    lights = Lights(str(sysfs))
    for name in ("os.open", "builtins.open"):
        monkeypatch.setattr(name, None)
    for state in range(len(STATES)):
        rig.loop.safety.state = state
        lights.serve(rig.loop)
    monkeypatch.undo()
    assert shown(sysfs) == [255, 0, 255, 0]


@pytest.fixture
def hearing(tmp_path):
    """A speaker, and a function that says which events it has got since, as (type, code, value)."""
    path = tmp_path / "speaker"
    os.mkfifo(str(path))
    end = os.open(str(path), os.O_RDONLY | os.O_NONBLOCK)

    def heard():
        try:
            data = os.read(end, 1000 * EVENT.size)
        except BlockingIOError:
            return []
        return [event[2:] for event in EVENT.iter_unpack(data)]

    speaker = Speaker(str(path))
    yield speaker, heard
    speaker.close()
    os.close(end)


def test_the_speaker_beeps_while_the_robot_shows_itself_and_is_silent_then(rig, hearing):
    speaker, heard = hearing
    assert speaker.ways == ("beep",)
    speaker.serve(rig.loop)
    assert heard() == []
    rig.loop.beacon.begin("'anna'", rig.clock.time)
    while rig.clock.time < LASTS_S + 1.0:
        speaker.serve(rig.loop)
        rig.run(1)
    beep = [(SOUND, TONE, TONE_HZ), (SOUND, TONE, 0)]
    assert heard() == beep * round(LASTS_S / PERIOD_S)


def test_a_program_that_ends_or_dies_within_a_beep_leaves_no_tone(rig, hearing):
    speaker, heard = hearing
    rig.loop.beacon.begin("'anna'", rig.clock.time)
    speaker.serve(rig.loop)
    speaker.silence()  # as the watchdog does in its own process
    speaker.close()
    assert heard() == [(SOUND, TONE, TONE_HZ), (SOUND, TONE, 0), (SOUND, TONE, 0)]


def test_a_brick_without_a_speaker_does_without(rig, tmp_path):
    speaker = Speaker(str(tmp_path / "none"))
    rig.loop.beacon.begin("'anna'", rig.clock.time)
    speaker.serve(rig.loop)
    speaker.silence()
    assert speaker.ways == ()
    speaker.close()


def test_a_robot_without_lights_says_once_that_somebody_looks_for_it(rig):
    words = []
    announcer = Announcer(words.append)
    announcer.serve(rig.loop)
    rig.loop.beacon.begin("'anna'", rig.clock.time)
    for _ in range(3):
        announcer.serve(rig.loop)
    assert words == ["kickctl identify: 'anna' is looking for this robot"]


def test_nobody_can_make_a_robot_beep_without_a_break(rig):
    beacon = rig.loop.beacon
    assert beacon.begin("'anna'", 10.0) == LASTS_S
    assert beacon.begin("'bert'", 12.0) == LASTS_S - 2.0
    assert (beacon.by, beacon.phase(10.0 + LASTS_S)) == ("'anna'", None)
    assert beacon.begin("'bert'", 10.0 + LASTS_S) == LASTS_S


@pytest.fixture
def device(tmp_path):
    """What a button is to a program: a file to read events from."""
    path = tmp_path / "event0"
    os.mkfifo(str(path))
    return path


@pytest.fixture
def pressing(device):
    """The button, and a function that sends it events as (type, code, value)."""
    button = BackButton(pytest.fail, str(device))
    end = os.open(str(device), os.O_WRONLY)
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


def test_a_button_that_cannot_be_read_says_that_it_does_not_stop_the_robot(rig, tmp_path):
    words = []
    button = BackButton(words.append, str(tmp_path / "none"))
    button.serve(rig.loop)
    button.close()
    assert len(words) == 1
    assert "the brick's back button does not stop the motors" in words[0]


def test_a_button_that_breaks_says_so_once(rig, tmp_path):
    words = []
    button = BackButton(words.append, str(tmp_path))  # a folder opens, but cannot be read
    rig.loop.start()
    for _ in range(3):
        button.serve(rig.loop)
    assert ["Is a directory" in line for line in words] == [True]


def test_the_brick_s_menu_gets_no_button_while_the_robot_runs(rig, pressing, monkeypatch):
    button, press = pressing
    grabs = []
    monkeypatch.setattr("robot.button.fcntl.ioctl", lambda file, what, arg: grabs.append(arg))
    button.serve(rig.loop)
    assert grabs == []
    rig.loop.start()
    button.serve(rig.loop)
    button.serve(rig.loop)
    assert grabs == [1]
    press((KEY, BACK, PRESSED))
    button.serve(rig.loop)
    assert grabs == [1, 0]
