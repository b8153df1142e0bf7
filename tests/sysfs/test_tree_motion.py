"""How motors move, brake and report it in the simulated kernel's files."""

from math import pi

import pytest

from tests.sysfs.files import MOTOR, Files


def test_a_duty_acts_at_once_under_run_direct_and_is_only_stored_before(files):
    files.write(MOTOR + "duty_cycle_sp", "60")
    files.wait(1.0)
    assert files.position == 0
    assert files.read(MOTOR + "duty_cycle") == "0"
    files.write(MOTOR + "command", "run-direct")
    files.wait(1.0)
    forward = files.position
    assert forward > 180
    assert (files.read(MOTOR + "duty_cycle"), files.read(MOTOR + "state")) == ("60", "running")
    files.write(MOTOR + "duty_cycle_sp", "-60")
    files.wait(1.5)
    assert files.position < forward


def test_the_duty_survives_a_stop_and_acts_again(files):
    files.run(60)
    files.wait(0.5)
    files.write(MOTOR + "command", "stop")
    files.wait(3.0)
    assert files.read(MOTOR + "duty_cycle") == "0"
    assert files.read(MOTOR + "duty_cycle_sp") == "60"
    before = files.position
    files.write(MOTOR + "command", "run-direct")
    files.wait(0.5)
    assert files.position > before + 90


def test_a_reset_forgets_everything(files):
    for name, value in {
        "stop_action": "brake",
        "polarity": "inversed",
        "ramp_up_sp": "100",
    }.items():
        files.write(MOTOR + name, value)
    files.run(60)
    files.wait(0.5)
    assert files.position > 90
    assert files.brick.truth()[0].motor_speed < 0
    files.write(MOTOR + "command", "reset")
    names = (
        "position",
        "duty_cycle_sp",
        "stop_action",
        "polarity",
        "ramp_up_sp",
        "state",
        "speed_pid/Kp",
    )
    assert [files.read(MOTOR + name) for name in names] == [
        "0",
        "0",
        "coast",
        "normal",
        "0",
        "",
        "1000",
    ]


def test_a_position_can_be_written_even_while_the_motor_runs(files):
    files.run(60)
    files.wait(0.5)
    files.write(MOTOR + "position", "-1000")
    assert files.position == -1000
    files.wait(0.5)
    assert files.position > -910


def test_duty_0_brakes_and_coasting_takes_longer(files):
    way = {}
    for action in ("duty 0", "brake", "coast"):
        files.run(60)
        files.wait(1.5)
        begin = files.position
        if action == "duty 0":
            files.write(MOTOR + "duty_cycle_sp", "0")
        else:
            files.write(MOTOR + "stop_action", action)
            files.write(MOTOR + "command", "stop")
        files.wait(6.0)
        assert files.read(MOTOR + "speed") == "0"
        way[action] = files.position - begin
    assert way["duty 0"] == pytest.approx(way["brake"], abs=2)
    assert way["coast"] > 2 * way["brake"]


def test_the_position_is_whole_degrees_sampled_every_2_ms(files):
    start = files.brick.truth()[0].motor_angle
    files.run(100)
    seen = []
    for _ in range(1000):
        files.wait(0.0005)
        seen.append(
            (files.now, files.position, (files.brick.truth()[0].motor_angle - start) * 180 / pi)
        )
    changes = [
        now for (now, new, _), (_, old, _) in zip(seen[1:], seen, strict=False) if new != old
    ]
    assert len(changes) > 100
    assert {round(now / 0.0005) % 4 for now in changes} == {0}
    fastest = max(
        after - before for (_, _, after), (_, _, before) in zip(seen[4:], seen, strict=False)
    )
    assert all(true - fastest - 1.5 <= position <= true + 0.5 for _, position, true in seen)


def test_the_speed_is_that_of_the_wheel_in_both_directions(files):
    for duty in (70, -70):
        files.run(duty)
        files.wait(2.0)
        true = files.brick.truth()[0].motor_speed * 180 / pi
        assert abs(true) > 300
        assert int(files.read(MOTOR + "speed")) == pytest.approx(true, rel=0.05)


def test_the_speed_is_zero_only_200_ms_after_the_last_count(files):
    files.run(70)
    files.wait(1.0)
    files.write(MOTOR + "duty_cycle_sp", "0")
    moved = files.now
    last, zero = files.position, None
    seen = []
    while zero is None:
        files.wait(0.002)
        if files.position != last:
            moved, last = files.now, files.position
        seen.append(int(files.read(MOTOR + "speed")))
        zero = files.now if seen[-1] == 0 else None
    # The last of the counts, two to a degree, may have come after the last whole degree.
    assert 0.198 <= zero - moved < 0.3
    assert min(speed for speed in seen if speed) <= 4


def test_a_motor_that_gets_stuck_is_called_stalled_late(files):
    files.run(40)
    files.wait(2.0)
    files.brick.set_load(0, -5.0)
    assert files.read(MOTOR + "state") == "running"
    files.first(lambda: files.brick.truth()[0].motor_speed < 0)
    files.brick.set_load(0, 0.0)
    files.write(MOTOR + "duty_cycle_sp", "0")
    files.first(lambda: files.brick.truth()[0].motor_speed == 0)
    assert 0.25 < files.first(lambda: files.read(MOTOR + "state") == "running stalled") < 0.42


def test_a_motor_that_never_moves_is_called_stalled_after_100_ms(files):
    files.run(1)
    assert 0.1 < files.first(lambda: files.read(MOTOR + "state") == "running stalled") < 0.12
    files.write(MOTOR + "command", "stop")
    assert files.read(MOTOR + "state") == ""


def test_nobody_looking_for_long_changes_nothing(files):
    files.run(60)
    files.wait(60.0)
    often = Files()
    often.run(60)
    for _ in range(60):
        often.wait(1.0)
    assert files.position == often.position
    assert files.read(MOTOR + "speed") == often.read(MOTOR + "speed")
