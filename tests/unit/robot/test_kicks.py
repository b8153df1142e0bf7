"""What a request for a kick may say: all else is refused, and all that is accepted runs."""

import json
from math import inf, isfinite, nan, pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot.errors import Refused
from robot.kick_requests import parse
from robot.kicks import (
    MODES,
    PULSED,
    REST_TRAVEL_RAD,
    WHEELS,
    Kick,
    direction,
    pulse_weight,
    reversing_shift,
)
from robot.params import TABLE, Params
from robot.wheel import Wheel

FIELDS = ("id", "mode", "wheel", "ticks", "shape", "shift", "param", "value", "variable", "delta")

scalars = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.integers(-10, 10010),
    st.floats(),
    st.floats(-10.0, 10.0),
    st.text(max_size=70),
)
words = st.sampled_from(
    (*MODES, *WHEELS, "both", "rectangular", "smooth", *sorted(PULSED), *TABLE, "x1", "x2")
)
json_like = st.recursive(
    scalars | words,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
)
wild = st.dictionaries(st.sampled_from(FIELDS) | st.text(max_size=5), json_like, max_size=8)
# Requests that often enough are sound, so that what is accepted is tried as well.
likely = st.fixed_dictionaries(
    {"id": st.text(min_size=1, max_size=64), "mode": st.sampled_from(MODES)},
    optional={
        "wheel": st.sampled_from((*WHEELS, "both")),
        "ticks": st.integers(-1, 12) | st.just(10000),
        "shape": st.sampled_from(("rectangular", "smooth")),
        "shift": st.none() | st.floats(-7.0, 7.0),
        "param": st.sampled_from((*sorted(PULSED), "rods")),
        "value": st.floats(-1.0, 1.0) | st.floats(0.0, 60.0),
        "variable": st.sampled_from(("x1", "x2", "x3")),
        "delta": st.floats(-2.5, 2.5),
    },
)
pulses = st.fixed_dictionaries(
    {
        "id": st.just("k"),
        "mode": st.just("pulse"),
        "param": st.sampled_from(sorted(PULSED)),
        "value": st.floats(-7.0, 60.0),
    },
    optional={"shape": st.just("smooth"), "ticks": st.integers(1, 120)},
)


def ask(**request):
    return parse({"id": "k", **request}, (1, 1), Params(), 3)


@given(
    wild | likely | pulses,
    st.tuples(*[st.sampled_from((-1, 0, 1))] * 2),
    st.sampled_from((0.03, 0.09)),
)
def test_any_request_is_refused_or_gives_a_kick_that_runs(request, directions, dt_s):
    params = Params()
    params.apply({"a": 50.0})
    try:
        kick = parse(request, directions, params, 0)
    except Refused as refusal:
        assert refusal.message
        assert refusal.code in ("usage", "range", "unknown")
        return
    assert json.loads(json.dumps(kick.as_dict(), allow_nan=False))["id"] == request["id"]
    for side in kick.wheels:
        wheel = Wheel(side)
        wheel.x1, wheel.x2 = 1.0, -1.0
        for tick in range(100):
            wheel.phi = 0.1 * tick
            torque = wheel.step(tick, dt_s, params, kick)
            assert isfinite(torque)
            assert max(abs(wheel.x1), abs(wheel.x2)) <= 3.0


@given(likely)
def test_a_kick_as_data_is_the_kick(request):
    try:
        kick = parse(request, (1, -1), Params(), 9)
    except Refused:
        return
    data = json.loads(json.dumps(kick.as_dict()))
    assert Kick(**data).as_dict() == kick.as_dict()


@pytest.mark.parametrize(
    ("request_", "code"),
    [
        ({}, "usage"),
        ({"mode": "shove"}, "usage"),
        ({"mode": ["phase"]}, "usage"),
        ({"mode": "phase", "id": ""}, "usage"),
        ({"mode": "phase", "id": "x" * 65}, "usage"),
        ({"mode": "phase", "id": 7}, "usage"),
        ({"mode": "phase", "speed": 1}, "usage"),
        ({"mode": "phase", "wheel": "middle"}, "usage"),
        ({"mode": "phase", "wheel": None}, "usage"),
        ({"mode": "phase", "shape": "round"}, "usage"),
        *(
            ({"mode": "phase", "ticks": ticks}, "range")
            for ticks in (0, -1, 10001, 2.0, True, "3", None, nan, inf, 10**30)
        ),
        *(
            ({"mode": "phase", "shift": shift}, "range")
            for shift in (nan, inf, -inf, 6.3, "1", True, [])
        ),
        ({"mode": "membrane", "ticks": 2}, "usage"),
        ({"mode": "jump", "variable": "x1", "delta": 1, "shape": "smooth"}, "usage"),
        ({"mode": "position", "shift": 1.0}, "usage"),
        ({"mode": "phase", "value": 1.0}, "usage"),
        ({"mode": "membrane", "param": "k"}, "usage"),
        ({"mode": "phase", "delta": 0.1}, "usage"),
        ({"mode": "pulse"}, "usage"),
        ({"mode": "pulse", "param": "k"}, "usage"),
        ({"mode": "pulse", "param": "rods", "value": 1}, "usage"),
        ({"mode": "pulse", "param": "tick_s", "value": 0.02}, "usage"),
        ({"mode": "pulse", "param": "k", "value": nan}, "range"),
        ({"mode": "pulse", "param": "k", "value": -0.1}, "range"),
        ({"mode": "pulse", "param": "tau_s", "value": 0.05}, "range"),
        ({"mode": "pulse", "param": "beta", "value": 1.1}, "range"),
        ({"mode": "pulse", "param": "shift_rad", "value": -6.3}, "range"),
        ({"mode": "jump", "variable": "x1"}, "usage"),
        ({"mode": "jump", "variable": "phi", "delta": 1.0}, "usage"),
        ({"mode": "jump", "variable": "x1", "delta": 2.1}, "range"),
    ],
)
def test_what_is_wrong_is_refused(request_, code):
    with pytest.raises(Refused) as refused:
        ask(**request_)
    assert refused.value.code == code


def test_the_defaults_are_the_papers():
    assert (ask(mode="phase").ticks, ask(mode="position").ticks, ask(mode="membrane").ticks) == (
        4,
        3,
        1,
    )
    assert ask(mode="phase").wheels == ("left", "right")
    assert ask(mode="phase").begin == 3
    assert not ask(mode="phase").smooth


@pytest.mark.parametrize(
    ("directions", "signs"),
    [
        ((1, 1), (1, 1)),
        ((-1, -1), (-1, -1)),
        ((1, -1), (1, -1)),
        ((-1, 1), (-1, 1)),
        ((0, -1), (1, -1)),
    ],
)
def test_a_phase_kick_takes_each_wheels_sign_from_its_direction(directions, signs):
    """A positive shift takes forward to backward (R10)."""
    kick = parse({"id": "k", "mode": "phase"}, directions, Params(), 0)
    assert kick.values == pytest.approx([sign * 3 * pi / 4 for sign in signs])
    given_sign = parse({"id": "k", "mode": "phase", "shift": -1.0}, directions, Params(), 0)
    assert given_sign.values == (-1.0, -1.0)


@pytest.mark.parametrize(
    ("travel", "expected"),
    [
        (1.0, 1),
        (-1.0, -1),
        (0.0, 0),
        (REST_TRAVEL_RAD, 0),
        (-REST_TRAVEL_RAD, 0),
        (1.01 * REST_TRAVEL_RAD, 1),
        (-1.01 * REST_TRAVEL_RAD, -1),
    ],
)
def test_two_counts_of_the_encoder_are_rest(travel, expected):
    assert direction(travel) == expected
    assert reversing_shift(expected) == pytest.approx((-1 if expected < 0 else 1) * 3 * pi / 4)


@given(st.integers(1, 10000), st.data())
def test_a_smooth_pulse_is_a_hump(ticks, data):
    age = data.draw(st.integers(0, ticks - 1))
    assert pulse_weight(age, ticks, smooth=False) == 1.0
    weight = pulse_weight(age, ticks, smooth=True)
    assert 0.0 < weight <= 1.0
    assert weight == pytest.approx(pulse_weight(ticks - 1 - age, ticks, smooth=True), abs=1e-12)
