"""--k, --tau, --a and --tick of the experiments: what they set, and what they do to claims."""

import pytest

from host.errors import NotDone, WrongUse
from host.experiments.registry import ROBOT, claimed
from host.experiments.robot import bifurcation, chaos, reliability, wall
from host.kicking.modes import CHAOS, MODES, WALL_TURNER
from host.link.robots_file import Known
from host.perform.robots import robots
from host.perform.run import perform
from host.runs.contract import POINT, Setting
from robot.kicks import POSITION
from robot.params import Params

WITH_PARAMETERS = ("reliability", "kick-map", "timeline", "bifurcation", "chaos", "wall")


def options(name, **own):
    return {option.name: option.default for option in ROBOT[name].options} | own


@pytest.mark.parametrize("name", WITH_PARAMETERS)
def test_the_defaults_are_those_for_which_the_claims_are_made(name):
    modes = {"chaos": MODES[CHAOS].params, "wall": MODES[WALL_TURNER].params}
    expected = dict(Params().values()) | modes.get(name, {})
    setting = Setting(1, options(name))
    assert {name: expected[name] for name in setting.own_params()} == setting.own_params()
    assert setting.elsewhere(**claimed(name)) == ""
    other = Setting(1, options(name, tick=0.02, a=5.0)).elsewhere(**claimed(name))
    assert other == "the claim is made for a = 4 (here 5), tick = 0.03 (here 0.02)"


@pytest.mark.parametrize("own", [{"tau": 0.05}, {"tick": 0.09}, {"tau": [0.031, 0.05]}])
def test_parameters_that_no_robot_takes_are_refused_before_the_first_piece(tmp_path, own):
    with pytest.raises(WrongUse, match="shorter than 3 ticks"):
        perform("timeline", out=tmp_path, **own)
    assert not list(tmp_path.iterdir())


class Look:
    """An experiment that only looks at the parameters of its robot."""

    def world(self, cell):
        return {}

    def trial(self, cell, robot, log, setting):
        return [{**log.info["params"], "status": robot.status()["params"]}]


def test_a_robot_gets_them_at_each_point(tmp_path):
    setting = Setting(1, options("timeline", k=7.0))
    with robots(Look(), Known("sim://", "sim://"), setting, None, tmp_path / "logs", print) as work:
        for tick_s in (0.02, 0.04):
            rows, _ = work({POINT: {"tick": tick_s, "a": 3.0}, "cell": {}})
            params = rows[0]["status"]
            assert (params["k"], params["a"], params["tick_s"]) == (7.0, 3.0, tick_s)
            assert rows[0]["tick_s"] == tick_s


def test_a_kick_of_three_short_ticks_reverses_no_wheel_and_one_of_long_ones_all():
    cell = {"mode": POSITION, "ticks": 3, "sign": 0}
    shares = [
        sum(row["reversed"] for row in rows) / len(rows)
        for tick_s in (0.015, 0.03)
        for rows in [
            reliability.simulate(cell, Setting(1, options("reliability", trials=5, tick=tick_s)))
        ]
    ]
    assert shares == [0.0, 1.0]
    with pytest.raises(NotDone, match="0 rolled forward and 0 backward"):
        reliability.simulate(cell, Setting(1, options("reliability", trials=1, k=0.1)))


def test_a_wheel_with_weak_springs_rests_instead_of_being_chaotic():
    setting = Setting(1, options("chaos", minutes=1.0, k=0.1, tick=0.02))
    series = chaos.simulate({"part": "series", "condition": "as it is"}, setting)
    assert len(series) == 3000
    assert abs(series[-1]["torque"]) < 0.1
    assert series[-1]["phi_rad"] == series[-500]["phi_rad"]
    findings = chaos.report(
        [{"part": "series", "condition": "as it is", **row} for row in series], setting
    )
    assert findings.claims[0].holds is None
    assert findings.numbers["parameters"] == {"k": 0.1, "tau_s": 1.0, "a": 4.0, "tick_s": 0.02}


def test_hits_and_sweeps_begin_at_their_k():
    assert {cell["k"] for cell in wall.cells(options("wall", k=3.0), batch=True)} == {3.0}
    assert bifurcation.ladder(9, 4.0)[-1] == 4.0
