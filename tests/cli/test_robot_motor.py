"""Which motor a robot has, as its hello says it, and what to do if nobody knows that motor."""

import json

import pytest

from host.errors import WrongUse
from host.experiments.robot.motors_entry import name_of
from host.kicking.robot_motor import EV3, known_entry, motor_of
from robot.ev3 import DRIVER
from sim_motor.constants import load


class Talker:
    """A robot that does nothing but say hello."""

    def __init__(self, **hello):
        self.hello = hello


OWN = """
[toy]
torque_constant = [0.3, "N m/A", "invented"]
emf_constant = [0.45, "V s/rad", "invented"]
resistance = [5.0, "ohm", "invented"]
inductance = [0.01, "H", "invented"]
inertia = [0.002, "kg m2", "invented"]
viscous_friction = [0.0, "N m s/rad", "invented"]
coulomb_friction = [0.02, "N m", "invented"]
"""


@pytest.fixture(autouse=True)
def own_file(tmp_path, monkeypatch):
    path = tmp_path / "motors.toml"
    path.write_text(OWN)
    monkeypatch.setenv("KICK_MOTORS", str(path))
    return path


def test_the_name_of_the_ev3s_motor_is_that_of_the_robots_program():
    assert EV3 == DRIVER


@pytest.mark.parametrize(
    ("hello", "entry"),
    [
        ({}, "pybricks"),  # of an older release, which drives the EV3's
        ({"motor": EV3}, "pybricks"),
        ({"motor": "pybricks"}, "pybricks"),
        ({"motor": "nxt_unroller"}, "nxt_unroller"),
        ({"motor": "toy"}, "toy"),
    ],
)
def test_a_robots_motor_has_its_own_entry(hello, entry):
    assert motor_of(Talker(**hello)) == load(entry)


def test_an_entry_that_is_named_counts_more_than_the_robots_own_word():
    assert motor_of(Talker(motor="nobody's"), "toy") == load("toy")
    with pytest.raises(WrongUse, match=r"no motor 'nosuch': published are pybricks.*toy"):
        motor_of(Talker(motor=EV3), "nosuch")


@pytest.mark.parametrize("motor", ["", "stepper", None, 3, ["pybricks"]])
def test_a_motor_that_nobody_knows_is_never_taken_for_the_ev3s(motor):
    with pytest.raises(WrongUse) as refusal:
        motor_of(Talker(motor=motor))
    assert "motor" in refusal.value.message
    assert "kickctl experiment calibrate" in refusal.value.hint
    assert "--motor" in refusal.value.hint
    if motor == "stepper":
        assert "'stepper'" in refusal.value.message


def test_an_entry_that_is_broken_is_named_and_not_taken_for_another(own_file):
    own_file.write_text("[toy]\nresistance = [5.0]\n")
    with pytest.raises(WrongUse, match=r"motor 'toy' in .*motors\.toml lacks"):
        motor_of(Talker(motor="toy"))
    assert known_entry("toy") is None


@pytest.mark.parametrize(
    ("model", "name"),
    [("toy", "toy"), ("", "mine"), (EV3, "mine"), ("pybricks", "mine"), ("a b", "mine")],
)
def test_a_measured_motor_gets_its_own_name_and_never_a_published_one(model, name):
    assert name_of(model) == name


# The commands.


@pytest.fixture
def foreign(monkeypatch):
    """The embedded robot says that its motor is a stepper."""
    monkeypatch.setattr("host.kicking.robot_motor.model_of", lambda robot: "stepper")


@pytest.mark.parametrize("verb", [("plan", "--to", "forward"), ("drive", "spin-left")])
def test_plan_and_drive_refuse_before_anything_moves_and_say_what_to_do(
    kickctl, foreign, verb, monkeypatch
):
    moved = []
    monkeypatch.setattr("host.client.robot.Robot.start", lambda robot: moved.append("start"))
    status, out, err = kickctl("--json", "--brick", "sim://?idle=1", *verb)
    assert status == 2
    assert "'stepper'" in json.loads(out)["error"]["message"]
    assert "kickctl experiment calibrate" in err
    assert moved == []
    assert kickctl(*verb, "--motor", "nosuch")[0] == 2


def test_with_an_entry_a_foreign_robot_is_planned_and_driven(kickctl, foreign):
    status, out, err = kickctl(
        "plan", "--to", "backward", "--motor", "toy", "--json", "--seed", "1"
    )
    assert status == 0, err
    assert json.loads(out)["wheels"]["left"]["rate"] >= 0.99
    assert kickctl("drive", "backward", "--motor", "toy", "--seed", "1")[0] == 0


def test_to_stop_a_robot_nobody_needs_to_know_its_motor(kickctl, foreign):
    assert kickctl("drive", "stopped", "--seed", "1")[0] == 0


def test_a_plan_is_kept_for_its_motor_alone(kickctl):
    plan = ("plan", "--to", "backward", "--seed", "1")
    assert "computing which kicks" in kickctl(*plan)[2]
    assert "computing which kicks" not in kickctl(*plan)[2]
    assert "computing which kicks" in kickctl(*plan, "--motor", "toy")[2]
