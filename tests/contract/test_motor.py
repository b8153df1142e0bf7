"""What the loop may expect of every robot.motors.Motor. Wheels must be free to turn.

A real brick's are put up on a box.

On a brick: KICK_TEST_PORTS=outB python3 -m pytest tests/contract -m brick
"""

import gc
import os
from math import pi

import pytest

from tests.contract.backends import REAL_PORTS, OnFiles, Simulated, real, refuses
from tests.sysfs.mount import mounted, needs_mount

pytestmark = [pytest.mark.filterwarnings("ignore:unclosed file:ResourceWarning")]

PATIENCE_S = 5.0
DRIVE = 50
# Far below what any motor moves at (2 to 5 % for a bare one).
STUCK = 1


@pytest.fixture(scope="module")
def live(tmp_path_factory):
    with mounted(tmp_path_factory.mktemp("live") / "sys", "--seed", "3") as folder:
        yield folder


@pytest.fixture(
    params=[
        "simulated",
        pytest.param("files", marks=needs_mount),
        pytest.param(
            "brick",
            marks=[
                pytest.mark.brick,
                pytest.mark.skipif(
                    REAL_PORTS not in os.environ, reason=f"name a port in {REAL_PORTS}"
                ),
            ],
        ),
    ]
)
def rig(request):
    if request.param == "files":
        rig = OnFiles(str(request.getfixturevalue("live")), "outB")
    else:
        rig = Simulated() if request.param == "simulated" else real()
    yield rig
    rig.close()
    gc.collect()


def turns_by(rig, angle):
    """Whether the motor turns so far (rad, with its sign) within PATIENCE_S."""
    begin = rig.motor.angle_rad()
    for _ in range(int(PATIENCE_S / 0.02)):
        rig.wait(0.02)
        if (rig.motor.angle_rad() - begin) / angle >= 1:
            return True
    return False


def comes_to_rest(rig):
    """Whether the motor rests within PATIENCE_S, for 0.3 s."""
    for _ in range(int(PATIENCE_S / 0.3)):
        begin = rig.motor.angle_rad()
        rig.wait(0.3)
        if rig.motor.angle_rad() == begin:
            return True
    return False


@pytest.mark.parametrize("sense", [1, -1])
def test_it_turns_the_way_of_its_duty(rig, sense):
    rig.motor.write_duty(sense * DRIVE)
    assert turns_by(rig, sense * pi)


def test_a_new_duty_acts_on_the_running_motor(rig):
    for sense in (1, -1, 1):
        rig.motor.write_duty(sense * DRIVE)
        assert turns_by(rig, sense * 1.0)


def test_angles_are_whole_degrees(rig):
    rig.motor.stop()
    begin = rig.motor.angle_rad()
    rig.motor.write_duty(DRIVE)
    assert turns_by(rig, 1.0)
    turned = (rig.motor.angle_rad() - begin) * 180 / pi
    assert turned == pytest.approx(round(turned), abs=1e-6)


@pytest.mark.parametrize("wrong", [101, -101, 33.5, float("nan"), None, "5"])
def test_what_is_no_duty_is_refused_and_the_one_before_stays(rig, wrong):
    rig.motor.write_duty(DRIVE)
    assert refuses(lambda: rig.motor.write_duty(wrong))
    assert turns_by(rig, 2.0)
    rig.motor.write_duty(-DRIVE)
    assert turns_by(rig, -1.0)


@pytest.mark.parametrize("duty", [100, -100])
def test_the_whole_range_is_there(rig, duty):
    rig.motor.write_duty(duty)
    assert turns_by(rig, duty / 100)


@pytest.mark.parametrize(
    "halt", [lambda motor: motor.stop(), lambda motor: motor.write_duty(0)], ids=["stop", "duty 0"]
)
def test_it_stops(rig, halt):
    rig.motor.write_duty(DRIVE)
    assert turns_by(rig, 2.0)
    halt(rig.motor)
    assert comes_to_rest(rig)


def test_it_may_be_stopped_at_any_time_any_number_of_times(rig):
    for _ in range(3):
        rig.motor.stop()
    rig.motor.write_duty(DRIVE)
    for _ in range(3):
        rig.motor.stop()
    assert comes_to_rest(rig)


def test_below_break_away_it_does_not_move_at_all(rig):
    rig.motor.stop()
    assert comes_to_rest(rig)
    begin = rig.motor.angle_rad()
    for duty in (STUCK, -STUCK, STUCK):
        rig.motor.write_duty(duty)
        rig.wait(0.5)
        assert rig.motor.angle_rad() == begin


def test_nothing_of_an_old_duty_is_left_after_a_stop(rig):
    rig.motor.write_duty(DRIVE)
    assert turns_by(rig, 1.0)
    rig.motor.stop()
    assert comes_to_rest(rig)
    begin = rig.motor.angle_rad()
    rig.motor.write_duty(0)
    rig.wait(0.5)
    rig.motor.write_duty(STUCK)
    rig.wait(0.5)
    assert rig.motor.angle_rad() == begin
    rig.motor.write_duty(-DRIVE)
    assert turns_by(rig, -1.0)


def test_finding_it_while_it_is_well_changes_nothing(rig):
    rig.motor.write_duty(DRIVE)
    assert turns_by(rig, 1.0)
    before = rig.motor.angle_rad()
    rig.motor.find()
    assert rig.motor.angle_rad() >= before
    assert turns_by(rig, 2.0)
