"""Motors of an engineer's own: what a factory may return, and what is refused in words."""

import importlib
import itertools
import math

import pytest

from robot import own_motors
from robot.own_motors import NoMotors
from robot.safety import FAULT
from tests.rig import Motor, Rig

_NUMBERS = itertools.count()

GOOD = """
from math import nan
from robot.motors import Battery, Motor, MotorFault

class Toy(Motor):
    model = "toy"
    duties = ()

    def angle_rad(self):
        return 1.5

    def write_duty(self, duty_pct):
        self.duties += (duty_pct,)

    def stop(self):
        self.duties += ("stop",)

class Cell(Battery):
    def voltage_v(self):
        return 7.4

def motors():
    return Toy(), Toy()
"""


NO_POWER = """
from robot.motors import MotorFault

def motors():
    raise MotorFault("the bus has no power: switch it on")
"""


@pytest.fixture
def module(tmp_path, monkeypatch):
    """A function that writes a module with a text, and returns the module's name."""
    monkeypatch.syspath_prepend(str(tmp_path))

    def write(text):
        name = "own_motors_{}".format(next(_NUMBERS))  # noqa: UP032 - as Python 3.5 has it
        (tmp_path / (name + ".py")).write_text(text)
        importlib.invalidate_caches()
        return name

    return write


def test_a_pair_of_motors_is_tried_out_and_left_stopped(module):
    (left, right), battery, faults = own_motors.load(module(GOOD) + ":motors")
    assert (battery, faults) == (None, [])
    assert left.duties == right.duties == (0, "stop")
    assert left is not right


def test_a_battery_may_be_the_third(module):
    name = module(GOOD + "\ndef all_three():\n    return [Toy(), Toy(), Cell()]\n")
    _, battery, _ = own_motors.load(name + ":all_three")
    assert battery.voltage_v() == 7.4


@pytest.mark.parametrize("method", ["find", "write_duty", "stop", "angle_rad"])
def test_a_motor_that_is_not_there_yet_is_a_fault_of_the_robot_and_no_reason_not_to_start(
    module, method
):
    lost = """
class Lost(Toy):
    def METHOD(self, *arguments):
        raise MotorFault("the left motor has no power: switch it on")

def lost():
    return Lost(), Toy()
""".replace("METHOD", method)
    (_, right), _, faults = own_motors.load(module(GOOD + lost) + ":lost")
    assert faults == ["the left motor has no power: switch it on"]
    assert right.duties == (0, "stop")


@pytest.mark.parametrize(
    "text",
    [
        "",
        "toy",
        "toy:",
        ":motors",
        "toy.py:motors",
        "toy:motors()",
        "./toy:motors",
        "a..b:c",
    ],
)
def test_what_names_no_factory_is_refused_with_an_example(text):
    with pytest.raises(NoMotors, match="as in toy:motors"):
        own_motors.load(text)


@pytest.mark.parametrize("name", ["nosuch_toy", "nosuch_toy.left", "math.nosuch", "robot.nosuch"])
def test_a_module_that_is_not_there_is_looked_for_where_the_words_say(name, tmp_path):
    with pytest.raises(NoMotors, match="no module " + name + " in .*in the folder of") as refusal:
        own_motors.load(name + ":motors")
    assert " in " + str(tmp_path) in str(refusal.value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("import nosuch_library", r"No module named 'nosuch_library' \(.*_\d+.py, line 1\)"),
        ("from math import nosuch", r"cannot import name 'nosuch'.*_\d+.py, line 1\)"),
        ("def motors(:", r"SyntaxError: .*_\d+.py, line 1\)"),
        ("a = 1\nb = a / 0", r"ZeroDivisionError: division by zero \(.*_\d+.py, line 2\)"),
        ("raise SystemExit('no GPIO here')", r"SystemExit: no GPIO here \(.*line 1\)"),
        ("x = 1", r"has no function motors"),
        ("motors = 3", r"has no function motors"),
        ("def motors():\n    raise OSError(5, 'no bus')", r"OSError: .*no bus \(.*line 2\)"),
        ("def motors():\n    return x", r"NameError: .*line 2\)"),
        ("def motors(port):\n    return port", r"TypeError: .*port"),
        ("def motors():\n    pass", "returned None: let it return the left and the right motor"),
        ("def motors():\n    return 1, 2, 3, 4", "let it return the left and the right"),
        (
            "def motors():\n    return 1, 2",
            "left motor of .* is 1: .*a subclass of robot.motors.M",
        ),
        (NO_POWER, "^the bus has no power: switch it on$"),
    ],
)
def test_a_module_or_factory_that_fails_is_refused_with_the_place(module, text, words):
    with pytest.raises(NoMotors, match=words):
        own_motors.load(module(text) + ":motors")


@pytest.mark.parametrize(
    ("body", "result", "words"),
    [
        ("angle_rad = Motor.angle_rad", "A(), Toy()", "left motor .* has no method angle_rad"),
        ("stop = None", "Toy(), A()", "right motor .* has no method stop: write it in class A"),
        ("write_duty = Motor.write_duty\n    stop = 3", "A(), A()", "write_duty and no stop"),
        ("angle_rad = lambda self: None", "A(), A()", "angle_rad of the left motor returned None"),
        ("angle_rad = lambda self: nan", "Toy(), A()", "angle_rad of the right motor returned nan"),
        ("angle_rad = lambda self: '1'", "A(), A()", "returned '1': let it return the angle"),
        ("write_duty = lambda self: 0", "A(), A()", "write_duty of the left motor failed: TypeErr"),
        ("stop = lambda self: 1 / 0", "A(), A()", "stop of the left motor failed: ZeroDivision"),
        ("find = lambda self: 1 / 0", "A(), A()", "find of the left motor failed: ZeroDivision"),
        ("model = 3", "A(), A()", "model of the left motor is 3"),
        ("emergency_stop = 3", "A(), A()", "emergency_stop of the left motor is 3"),
        ("one = None", "[A()] * 2", "the same motor twice"),
        ("one = None", "A(), A(), 7.4", "battery of .* is 7.4: .*robot.motors.Battery"),
        ("one = None", "A(), A(), Battery()", "battery of .* has no method voltage_v"),
    ],
)
def test_a_motor_that_cannot_do_what_it_must_is_refused(module, body, result, words):
    text = "\nclass A(Toy):\n    " + body + "\n\ndef wrong():\n    return " + result + "\n"
    with pytest.raises(NoMotors, match=words):
        own_motors.load(module(GOOD + text) + ":wrong")


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("voltage_v = lambda self: '7.2'", "returned '7.2': let it return the voltage in V"),
        ("voltage_v = lambda self: nan", "voltage_v of the battery returned nan"),
        ("voltage_v = lambda self: 1 / 0", r"voltage_v .* failed: ZeroDivisionError: .*line \d"),
        ("def voltage_v(self): raise MotorFault('no bus')", "voltage_v .* failed: no bus"),
        ("warn_v = '6'", "warn_v of the battery is '6': make it a voltage"),
        ("stop_v = None", "stop_v of the battery is None"),
    ],
)
def test_a_battery_that_cannot_be_watched_is_refused(module, body, words):
    text = "\nclass A(Cell):\n    " + body + "\n\ndef wrong():\n    return Toy(), Toy(), A()\n"
    with pytest.raises(NoMotors, match=words):
        own_motors.load(module(GOOD + text) + ":wrong")


def test_a_battery_that_cannot_be_read_now_is_no_reason_not_to_start(module):
    text = "\nclass A(Cell):\n    voltage_v = lambda self: None\n"
    text += "\ndef motors():\n    return Toy(), Toy(), A()\n"
    _, battery, faults = own_motors.load(module(GOOD + text) + ":motors")
    assert (battery.voltage_v(), faults) == (None, [])


def test_the_watchdog_stops_each_motor_that_it_can_and_names_those_that_fail(module):
    text = (
        GOOD
        + """
class Watched(Toy):
    calls = 0

    def emergency_stop(self):
        self.calls += 1

class Stuck(Toy):
    def emergency_stop(self):
        raise OSError(5, "no bus")

def both():
    return Watched(), Watched()

def one():
    return Stuck(), Watched()

def none():
    return Toy(), Watched()
"""
    )
    name = module(text)
    both, _, _ = own_motors.load(name + ":both")
    assert (own_motors.unwatched(both), own_motors.stop_all(both)) == ([], [])
    assert [motor.calls for motor in both] == [1, 1]
    one, _, _ = own_motors.load(name + ":one")
    (line,) = own_motors.stop_all(one)
    assert line.startswith("left motor: ")
    assert "no bus" in line
    assert one[1].calls == 1
    none, _, _ = own_motors.load(name + ":none")
    assert own_motors.unwatched(none) == ["left"]
    assert own_motors.stop_all(none) == []


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf, None, "2", [0.5], 10**400])
def test_an_angle_that_is_no_number_stops_the_robot_and_is_in_no_record(wrong):
    rig = Rig()
    rig.loop.start()
    rig.motors[1].angle_rad = lambda: wrong
    rig.run()
    assert rig.loop.safety.state == FAULT
    said = "the right motor's angle is no number: " + repr(wrong)
    assert rig.loop.safety.reason.startswith(said[:80])
    assert rig.duties == (0, 0)
    assert all(math.isfinite(value) for record in rig.records for value in record)


def test_the_robot_says_its_motor_if_both_are_of_one_model():
    left, right = Motor(), Motor()
    left.model = right.model = "toy"
    assert Rig(left, right).loop.motor == "toy"
    right.model = "other"
    assert Rig(left, right).loop.motor == ""
    assert Rig().loop.motor == ""
