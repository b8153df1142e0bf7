"""A wheel's ticks under a kick.

What it changes, when, on which wheel, and what it must leave alone.
"""

from itertools import product
from math import cos, pi, sin

import pytest

from robot.controller import step_wheel
from robot.kick_requests import parse
from robot.kicks import Kick
from robot.params import Params
from robot.wheel import Wheel

PHI = 0.7
DT = 0.03


def make(mode, directions=(1, 1), begin=5, **details):
    return parse(dict(details, id="k", mode=mode), directions, Params(), begin)


def wheel(side="left", x1=0.4, x2=-0.3, phi=PHI):
    one = Wheel(side)
    one.x1, one.x2, one.phi = x1, x2, phi
    return one


def stepped(kick, tick=5, side="left", phi=PHI, dt_s=DT):
    """(x1, x2, force, torque) of a tick from the same potentials every time."""
    one = wheel(side, phi=phi)
    one.step(tick, dt_s, Params(), kick)
    return one.x1, one.x2, one.force, one.torque


def expected(x1=0.4, x2=-0.3, seen=PHI, sign=1.0, a=4.0, tau_s=0.25, k=8.0):
    return step_wheel(
        x1, x2, *2 * (cos(PHI), sin(PHI)), sign * cos(seen), sign * sin(seen), DT, a, tau_s, k, 2
    )


def test_without_a_kick_the_neurons_see_the_wheel_as_it_is():
    assert stepped(None) == expected()


@pytest.mark.parametrize(
    ("kick", "result"),
    [
        (make("membrane"), expected(x1=-0.4, x2=0.3)),
        (make("position"), expected(sign=-1.0)),
        (make("phase", directions=(1, -1)), expected(seen=PHI + 3 * pi / 4)),
        (make("phase", directions=(-1, 1)), expected(seen=PHI - 3 * pi / 4)),
        (make("phase", shift=0.5), expected(seen=PHI + 0.5)),
        (make("pulse", param="k", value=1.0), expected(k=1.0)),
        (make("pulse", param="a", value=2.0), expected(a=2.0)),
        (make("pulse", param="tau_s", value=0.5), expected(tau_s=0.5)),
        (make("pulse", param="beta", value=0.25), expected(sign=0.5)),
        (make("pulse", param="shift_rad", value=-1.0), expected(seen=PHI - 1.0)),
        (make("jump", variable="x1", delta=0.5), expected(x1=0.9)),
        (make("jump", variable="x2", delta=-0.5), expected(x2=-0.8)),
    ],
)
def test_what_each_kick_does_to_a_tick(kick, result):
    assert stepped(kick) == pytest.approx(result, abs=1e-15)
    assert stepped(kick) != stepped(None)


@pytest.mark.parametrize("mode", ["membrane", "position", "phase", "pulse", "jump"])
def test_a_kick_acts_in_its_ticks_and_on_its_wheel_only(mode):
    details = {
        "pulse": {"param": "k", "value": 0.5, "ticks": 3},
        "jump": {"variable": "x1", "delta": 0.1},
    }.get(mode, {})
    kick = make(mode, wheel="right", **details)
    acted = [tick for tick in range(20) if stepped(kick, tick, "right") != stepped(None)]
    assert acted == list(range(5, 5 + kick.ticks))
    assert all(stepped(kick, tick, "left") == stepped(None) for tick in range(20))


@pytest.mark.parametrize(
    "kick", [make("position"), make("phase"), make("pulse", param="beta", value=1.0)]
)
def test_a_kick_alters_what_neurons_see_and_never_the_projection(kick):
    """Neurons that cannot move (dt = 0) hide what is done to their sight.

    A kick of the projection would show in the force.
    """
    assert stepped(kick, dt_s=0.0) == stepped(None, dt_s=0.0)
    assert stepped(kick) != stepped(None)


def test_the_neurons_step_before_they_act():
    """The force belongs to the potentials of the same record: of x after the step, not before."""
    one = wheel()
    one.step(0, DT, Params(), None)
    after = step_wheel(one.x1, one.x2, *2 * (cos(PHI), sin(PHI)), 0.0, 0.0, 0.0, 4.0, 0.25, 8.0, 2)
    before = step_wheel(0.4, -0.3, *2 * (cos(PHI), sin(PHI)), 0.0, 0.0, 0.0, 4.0, 0.25, 8.0, 2)
    assert (one.force, one.torque) == after[2:]
    assert one.force != before[2]


def test_a_membrane_kick_acts_before_the_step_of_its_tick():
    """A wheel at rest at its fixpoint: inverted first, then drawn back by dt/tau.

    Inverted last it would be exactly opposite.
    """
    one = wheel(x1=1.0, x2=0.0, phi=0.0)
    one.step(5, DT, Params(), make("membrane"))
    assert one.x1 == pytest.approx(-1.0 + 2.0 * DT / 0.25)


def test_a_smooth_pulse_swells_and_fades_evenly_and_a_rectangular_one_is_all_there():
    def shares(**details):
        # With a wheel at phi = 0 and dt = tau the first neuron becomes what it sees: 1 - 2 beta.
        kick = make("pulse", param="beta", value=1.0, ticks=5, **details)
        return [(1.0 - stepped(kick, tick, phi=0.0, dt_s=0.25)[0]) / 2.0 for tick in range(4, 11)]

    assert shares() == pytest.approx([0, 1, 1, 1, 1, 1, 0])
    smooth = shares(shape="smooth")
    # sin^2 of 18, 54, 90, 126 and 162 degrees.
    assert smooth == pytest.approx([0, 0.0954915, 0.6545085, 1, 0.6545085, 0.0954915, 0], abs=1e-7)


def test_after_a_quenched_kick_everything_is_as_before():
    params = Params()
    before = dict(params.values())
    for mode, ticks in product(("position", "phase"), (1, 4)):
        kick = make(mode, ticks=ticks)
        one = wheel()
        for tick in range(12):
            one.step(tick, DT, params, kick)
    assert dict(params.values()) == before


def test_jumps_cannot_carry_a_potential_out_of_the_range_of_the_exponential():
    one = wheel()
    params = Params()
    params.apply({"a": 50.0, "tau_s": 10.0})
    for tick in range(200):
        one.step(
            tick, DT, params, Kick("k", "jump", ("left",), 1, variable="x1", delta=-2.0, begin=tick)
        )
    assert -10.0 <= one.x1 <= -9.0


def test_a_resting_wheel_keeps_its_potentials():
    one = wheel()
    one.step(0, DT, Params(), None)
    potentials = one.x1, one.x2
    one.rest()
    assert (one.x1, one.x2, one.force, one.torque) == (*potentials, 0.0, 0.0)


def test_rods_lag_behind_a_wheel_that_was_under_control_in_the_tick_before():
    """In its first tick, also the first after a rest, there is no angle to lag behind."""
    params = Params()
    params.apply(params.check({"rod_lag_s": 0.01}))
    one, fresh = wheel(), wheel()
    for rests in (False, True):
        one.step(0, DT, params, None)
        fresh.step(0, DT, Params(), None)
        assert (one.x1, one.x2, one.force) == (fresh.x1, fresh.x2, fresh.force)
        one.phi += 0.3
        fresh.phi += 0.3
        one.step(1, DT, params, None)
        fresh.step(1, DT, Params(), None)
        assert (one.x1, one.x2) == (fresh.x1, fresh.x2)
        assert one.force - fresh.force == pytest.approx(-params.k * sin(0.1), abs=1e-12)
        if not rests:
            one.rest()


@pytest.mark.parametrize("kick", [None, make("position")])
def test_a_kick_leaves_lagging_rods_alone(kick):
    params = Params()
    params.apply(params.check({"rod_lag_s": 0.01}))
    one = wheel()
    one.step(4, DT, params, None)
    one.phi = PHI + 0.3
    one.step(5, DT, params, kick)
    actual, rods = (cos(PHI + 0.3), sin(PHI + 0.3)), (cos(PHI + 0.2), sin(PHI + 0.2))
    pull = step_wheel(one.x1, one.x2, *actual, *rods, 0.0, 0.0, 0.0, 4.0, 0.25, 8.0, 2)[2]
    assert one.force == pytest.approx(pull, abs=1e-12)
