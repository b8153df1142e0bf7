"""Calibration against robots whose constants are known.

What is found is true, as sharp as is said, and enough to simulate the robot.
"""

import tomllib
from copy import deepcopy
from dataclasses import replace
from math import degrees, pi, sin
from pathlib import Path

import numpy as np
import pytest
from matplotlib.table import Cell
from scipy.special import stdtrit

from host.client.robot import Robot, connect
from host.errors import NotDone, WrongUse
from host.experiments.robot import calibrate
from host.experiments.robot.calibrate_rows import drive_of
from host.experiments.robot.identification import (
    Drive,
    break_away,
    half_intervals,
    identify,
    middle,
)
from host.experiments.robot.motor_traits import Traits, constants_of, traits
from host.figures.robot.calibrate import draw
from host.link.sim import SimLink
from host.logs.log import Log
from host.runs.contract import Setting
from robot.kicks import MEMBRANE, WHEELS, Kick
from robot.params import Params
from sim_motor import batch
from sim_motor.arrays import tables
from sim_motor.brick import SimBrick
from sim_motor.constants import load, names
from sim_motor.motor import encoder

SECONDS = 60.0
# Every constant is another than the published motor's, also those which the fit takes from there.
ODD = """
[odd]
torque_constant = [0.33, "N m/A", "invented"]
emf_constant = [0.43, "V s/rad", "invented"]
resistance = [6.6, "ohm", "invented"]
inductance = [0.008, "H", "invented"]
inertia = [0.0034, "kg m2", "invented"]
viscous_friction = [0.0008, "N m s/rad", "invented"]
coulomb_friction = [0.024, "N m", "invented"]
break_away_duty = [11.4, "%", "invented"]
latency = [0.0052, "s", "invented"]
backlash = [5.0, "deg", "invented"]
source_resistance = [0.25, "ohm", "invented"]
battery_voltage = [8.1, "V", "invented"]
"""
WIDEST = Traits(0.03, 0.004, 0.25, 1.0, 0.3, 0.025, 1.6, 4.5)


@pytest.fixture(scope="module")
def own_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("own") / "motors.toml"
    path.write_text(ODD)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("KICK_MOTORS", str(path))
        yield path


SETTING = Setting(1, {"seconds": SECONDS})


def drive(brick, **changes):
    """The rows of a robot on this brick with these parameters, and its status afterwards."""
    link = SimLink("sim://", brick, idle=True)
    with Robot(link, link.token) as robot:
        robot.set(k=8.0, **changes)
        robot.start()
        log = Log(robot.info())
        robot.add_tap(log)
        rows = calibrate.trial(
            calibrate.cells(SETTING.options, batch=False)[0], robot, log, SETTING
        )
        return rows, robot.status()


def misses(brick, numbers):
    """How far each wheel's traits are from the truth, in halves of their intervals."""
    out = []
    for side, motor in zip(WHEELS, brick.motors, strict=True):
        truth = traits(motor.constants, numbers["battery_v"])
        for name, true in truth._asdict().items():
            low, high = numbers["intervals"][side][name]
            out.append(abs(true - (low + high) / 2) / ((high - low) / 2))
    return np.array(out)


@pytest.fixture(scope="module")
def odd(own_file):
    """Odd robots, each with its rows and what was found."""
    bricks = [SimBrick(seed, motor="odd") for seed in (1, 2)]
    # Of a robot that does not say its motor, or its own entry would be the first guess.
    rows = [[{**row, "motor": ""} for row in drive(brick)[0]] for brick in bricks]
    return [
        (brick, one, calibrate.report(one, SETTING))
        for brick, one in zip(bricks, rows, strict=True)
    ]


def test_constants_are_recovered_within_their_intervals(odd):
    far = np.concatenate([misses(brick, findings.numbers) for brick, _, findings in odd])
    assert len(far) == 32
    assert (far > 1).sum() <= 4  # of intervals of 95 % one or two in the mean
    assert far.max() < 2


def test_the_intervals_are_worth_something(odd):
    for _, _, findings in odd:
        for side in WHEELS:
            for name, (low, high) in findings.numbers["intervals"][side].items():
                assert high - low <= 2 * getattr(WIDEST, name), name
            assert findings.numbers["rms_deg"][side] < 0.35  # a count of the encoder leaves 0.29


def test_a_run_that_was_not_fitted_is_predicted(odd):
    """Six seconds and a kick, about 50 turns there and back, without the wheel's true angle."""
    for _, _, findings in odd:
        for check in findings.numbers["check"].values():
            assert check["rms_deg"] < 5
            assert abs(check["way"]) < 0.01


def closed_loop(constants):
    """What robots with these constants do.

    ([turns a second, duty in %, seconds to settle after a kick], share that the kick reversed).
    """
    params = Params()
    params.k = 3.0
    kick = Kick("k", MEMBRANE, WHEELS, 1, begin=170)
    result = batch.run(400, 300, 7, motors=(constants,), params=params, kick=kick, record=400)
    phi, duty = result.records[:, :, 0], np.abs(result.records[:, :, 5])
    speed = np.abs(phi[:, 160] - phi[:, 110]) / (result.times[:, 160] - result.times[:, 110])
    return (
        np.array([speed.mean() / (2 * pi), duty[:, 110:160].mean(), np.nanmean(result.settled_s)]),
        result.reversed.mean(),
    )


def test_the_entry_makes_a_robot_that_behaves_as_the_one_measured(odd, own_file):
    _, _, findings = odd[0]
    own_file.write_text(ODD + findings.files["motors.toml"])
    with connect("sim://?motor=mine", 1) as robot:
        assert robot.status()["battery_v"] == pytest.approx(8.1)
    (measured, share), (mine, share_mine), (published, _) = (
        closed_loop(load(name)) for name in ("odd", "mine", "pybricks")
    )
    assert np.all(np.abs(mine / measured - 1) < [0.005, 0.005, 0.04])
    assert np.all(np.abs(published / measured - 1) > [0.05, 0.01, 0.1])
    assert abs(share_mine - share) < 0.08


def test_a_foreign_motor_gets_an_entry_of_its_own_name_and_says_what_is_of_the_ev3(odd):
    _, rows, _ = odd[0]
    text = calibrate.report([{**row, "motor": "toy"} for row in rows], SETTING).files["motors.toml"]
    assert "\n[toy]\n" in text
    assert "sim://?motor=toy is this robot" in text
    assert set(tomllib.loads(text)["toy"]) == set(tomllib.loads(ODD)["odd"])
    assert "as of pybricks" in tomllib.loads(text)["toy"]["resistance"][2]


def test_a_motor_with_an_entry_takes_from_it_what_a_drive_does_not_show(own_file, odd):
    _, rows, _ = odd[0]
    text = calibrate.report([{**row, "motor": "odd"} for row in rows], SETTING).files["motors.toml"]
    entry = tomllib.loads(text)["odd"]
    assert entry["resistance"] == [6.6, "ohm", entry["resistance"][2]]
    assert "as of odd" in entry["resistance"][2]


def test_a_disturbance_that_no_model_knows_widens_the_intervals(odd):
    """An eccentric gear, a sixth of the friction; the right motor is mounted mirrored."""
    brick = SimBrick(4, mount=(1, -1))

    def rub(motor, write):
        def disturbed(duty):
            motor.set_load(0.003 * sin(3 * motor.truth().wheel_angle + 1))
            write(duty)

        return disturbed

    for motor in brick.motors:
        motor.write_duty = rub(motor, motor.write_duty)
    rough = calibrate.report(drive(brick, polarity_right=-1)[0], SETTING).numbers
    assert misses(brick, rough).max() < 2
    for side in WHEELS:
        assert 0.4 < rough["rms_deg"][side] < 1.0
        for name in ("speed_per_v", "time_constant_s"):
            widths = [
                float(np.diff(numbers["intervals"][side][name])[0])
                for numbers in (rough, odd[0][2].numbers)
            ]
            assert widths[0] > 1.2 * widths[1]


def regression(seed):
    """Effects of three traits on the errors of 20 stretches of 10 ticks, and these errors."""
    rng = np.random.default_rng(seed)
    stretches = np.repeat(np.arange(20), 10)
    errors = rng.normal(size=200) + rng.normal(size=20)[stretches]
    return rng.normal(size=(200, 3)) * [1e-3, 1.0, 1e3], errors, stretches


def test_intervals_are_those_of_a_fit_whose_stretches_are_the_observations():
    jacobian, errors, stretches = regression(1)
    inverse = np.linalg.inv(jacobian.T @ jacobian)
    scores = [jacobian[stretches == n].T @ errors[stretches == n] for n in range(20)]
    variance = inverse @ sum(np.outer(one, one) for one in scores) @ inverse * 20 / 17
    expected = 2.1098156 * np.sqrt(np.diag(variance))  # Student's t for 17 degrees of freedom
    assert half_intervals(jacobian, errors, stretches) == pytest.approx(expected, rel=1e-6)


def test_a_trait_that_the_drive_does_not_show_may_have_any_value():
    """As friction below that of rolling: its interval was of no width, or no number."""
    jacobian, errors, stretches = regression(2)
    blind = np.insert(jacobian, 1, 0.0, axis=1)
    half = half_intervals(blind, errors, stretches)
    assert half[1] == np.inf
    others = half_intervals(jacobian, errors, stretches) * stdtrit(16, 0.975) / stdtrit(17, 0.975)
    assert np.delete(half, 1) == pytest.approx(others * np.sqrt(17 / 16), rel=1e-9)


def test_traits_that_cannot_be_told_apart_may_have_any_value():
    jacobian, errors, stretches = regression(3)
    alone = half_intervals(jacobian, errors, stretches)
    alike = np.column_stack([jacobian, 1e9 * jacobian[:, 2]])
    half = half_intervals(alike, errors, stretches)
    assert np.isinf(half).tolist() == [False, False, True, True]
    assert half[:2] == pytest.approx(alone[:2], rel=0.1)


def test_the_robot_is_left_stopped_with_its_own_parameters():
    own = {"a": 3.0, "tick_s": 0.04, "max_duty_pct": 70.0, "tau_s": 0.5, "duty_scale": 1.25}
    rows, status = drive(SimBrick(5), **own)
    assert status["state"] == "stopped"
    assert {name: status["params"][name] for name in own} == own
    assert max(abs(row[side + "_duty_pct"]) for row in rows for side in WHEELS) <= 70


def test_the_same_seed_gives_the_same_rows_and_the_figure_is_drawn_from_them(odd):
    _, rows, findings = odd[0]
    again, _ = drive(SimBrick(1, motor="odd"))
    assert {row["motor"] for row in again} == {"odd"}
    own = {"date": "", "motor": ""}
    assert [{**row, **own} for row in again] == [{**row, **own} for row in rows]
    # A motor without latency: the intervals of both wheels lie at the bound, and have no width.
    sharp = deepcopy(findings)
    for side in WHEELS:
        sharp.numbers["intervals"][side]["delay_ms"] = (1.25, 1.25)
    figure = draw(rows, sharp)
    assert figure.get_size_inches()[0] * 160 == 1920
    cells = [cell.get_text().get_text() for cell in figure.findobj(Cell)]
    assert any("(1.250 to 1.250)" in text for text in cells)


def test_too_few_stretches_are_not_made_into_intervals(odd):
    _, rows, _ = odd[0]
    few = drive_of(rows, "left")
    with pytest.raises(NotDone, match="5 stretches of motion are too few"):
        identify(few, np.isin(few.stretches, [1, 2, 3, 5, 6]), (8.0, 9.0), load(), 8.1)


def test_a_wheel_that_is_blocked_is_named_as_the_reason():
    brick = SimBrick(1)
    brick.motors[0].angle_rad = lambda: 0.0
    with pytest.raises(NotDone, match="does not move at 40 % duty"):
        drive(brick)


def ramp(duty_of_motion):
    duties = np.repeat(np.arange(15), 10)
    moves = np.cumsum(duties >= duty_of_motion)
    return duties, np.radians(np.concatenate(([0], moves[:-1])))


@pytest.mark.parametrize(("moved", "interval"), [((9, 9), (8, 9)), ((7, 11), (6, 11))])
def test_break_away_lies_between_the_last_duty_that_held_and_the_first_that_did_not(
    moved, interval
):
    ramps = [ramp(duty) for duty in moved]
    duties, angles = (np.concatenate(parts) for parts in zip(*ramps, strict=True))
    stretches = np.repeat([3, 8], len(ramps[0][0]))
    assert (
        break_away(Drive(np.arange(len(duties)) * 0.02, angles, -duties, stretches), [3, 8])
        == interval
    )


@pytest.mark.parametrize("polarity", [1, -1])
def test_the_middle_of_a_reading_is_where_the_angle_is_on_average(polarity):
    angles = np.linspace(-8, 8, 4001)
    readings = np.array(
        [polarity * encoder(0, float(polarity * angle), 0.0, 720.0) * pi / 180 for angle in angles]
    )
    off = np.degrees(middle(readings, polarity) - angles)
    assert np.abs(off).max() < 0.76  # the count around zero is the widest: one and a half degrees
    for part in (angles > 0.05, angles < -0.05):
        assert abs(off[part].mean()) < 0.01


@pytest.mark.parametrize("name", names())
def test_traits_say_all_that_constants_do_except_for_what_is_published(name):
    constants = load(name)
    other = replace(
        constants,
        emf_constant=0.6,
        viscous=0.1,
        kinetic=0.1,
        static=0.2,
        motor_inertia=0.01,
        backlash=0.3,
        latency_s=0.1,
    )
    back = constants_of(traits(constants, 7.9), other, 7.9)
    assert (back.latency_s, back.battery_v) == pytest.approx((constants.latency_s, 7.9))
    assert np.allclose(back.scalars(), constants.scalars())
    assert np.allclose(tables([back]), tables([constants]))


def entry_of(changes, lack=()):
    values = {
        key: row[0] for key, row in tomllib.loads(ODD)["odd"].items() if key not in lack
    } | changes
    return "[odd]\n" + "\n".join(f'{key} = [{value}, "", ""]' for key, value in values.items())


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[odd]\n" * 2, "cannot be read: Cannot declare"),
        (
            "[other]",
            "no motor 'odd': published are pybricks, nxt_unroller, and your own in .*: other",
        ),
        (entry_of({}, lack=["inertia"]), "lacks inertia"),
        (entry_of({"latencyy": 0.1}), "nobody knows, latencyy"),
        (entry_of({"resistance": 0.0}), r"no \[value, unit, source\] that can be, in resistance"),
        (entry_of({"latency": "nan"}), "in latency"),
        (entry_of({"backlash": '"much"'}), "in backlash"),
        ("odd = 3", "lacks torque_constant"),
        (entry_of({"inductance": 1e-12}), "cannot be simulated: .* too small"),
        (entry_of({"inertia": 1e-300}), "cannot be simulated: .* too small"),
        (entry_of({"torque_constant": 1e300}), "cannot be simulated: .* too large"),
    ],
)
def test_a_bad_file_of_own_motors_is_reported_in_words(text, words, tmp_path, monkeypatch):
    path = tmp_path / "motors.toml"
    path.write_text(text)
    monkeypatch.setenv("KICK_MOTORS", str(path))
    with pytest.raises(WrongUse, match=words) as error:
        connect("sim://?motor=odd")
    assert str(path) in error.value.message
    assert load().torque_constant == 0.2746  # who does not use it, is not disturbed by it


def test_an_own_motor_is_found_in_the_configuration_folder(tmp_path, monkeypatch):
    monkeypatch.delenv("KICK_MOTORS", raising=False)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    with pytest.raises(ValueError, match="your own would be in"):
        load("odd")
    folder = Path(tmp_path, "kickctl")
    folder.mkdir()
    (folder / "motors.toml").write_text(ODD)
    assert degrees(load("odd").backlash) == pytest.approx(5.0)
    assert load("odd").wheel_radius == load().wheel_radius
    assert load("odd").battery_v == 8.1
