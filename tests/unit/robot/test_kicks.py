"""What a request for a kick may say: all else is refused, and all that is accepted runs."""

import json
from math import inf, isfinite, nan, pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot.errors import Refused
from robot.kick_requests import FIELDS, parse
from robot.kicks import (
    MAX_WAVEFORM,
    MODES,
    PULSED,
    REST_TRAVEL_RAD,
    WHEELS,
    X_LIMIT,
    Kick,
    direction,
    pulse_weight,
    reversing_shift,
)
from robot.params import TABLE, Params
from robot.wheel import Wheel
from robot.wire import MAX_PAYLOAD

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
waveforms = st.fixed_dictionaries(
    {
        "id": st.just("k"),
        "mode": st.just("waveform"),
        "param": st.sampled_from((*sorted(PULSED), "x1", "x2")),
        "waveform": st.lists(st.floats(0.1, 1.0) | st.floats(-2.5, 2.5), max_size=9),
    },
)


def ask(**request):
    return parse({"id": "k", **request}, (1, 1), Params(), 3)


@given(
    wild | likely | pulses | waveforms,
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
            assert max(abs(wheel.x1), abs(wheel.x2)) <= (X_LIMIT if kick.waveform else 3.0)


@given(likely | waveforms)
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
        ({"mode": "waveform", "param": "k"}, "usage"),
        ({"mode": "waveform", "waveform": [1.0]}, "usage"),
        ({"mode": "waveform", "param": "rods", "waveform": [1]}, "usage"),
        ({"mode": "waveform", "param": "k", "waveform": [1.0], "ticks": 1}, "usage"),
        ({"mode": "waveform", "param": "k", "waveform": [1.0], "shape": "smooth"}, "usage"),
        ({"mode": "pulse", "param": "k", "value": 1.0, "waveform": [1.0]}, "usage"),
        ({"mode": "pulse", "param": "x1", "value": 1.0}, "usage"),
        ({"mode": "waveform", "param": "k", "waveform": 8.0}, "usage"),
        ({"mode": "waveform", "param": "k", "waveform": []}, "range"),
        ({"mode": "waveform", "param": "k", "waveform": [8.0] * 101}, "range"),
        ({"mode": "waveform", "param": "k", "waveform": [8.0, -1.0]}, "range"),
        ({"mode": "waveform", "param": "x1", "waveform": [0.0, nan]}, "range"),
        ({"mode": "waveform", "param": "tau_s", "waveform": [0.25, 0.05]}, "range"),
    ],
)
def test_what_is_wrong_is_refused(request_, code):
    with pytest.raises(Refused) as refused:
        ask(**request_)
    assert refused.value.code == code


def run_wheel(kick):
    """The states of a wheel under a kick, tick by tick."""
    wheel, states = Wheel("left"), []
    wheel.x1, wheel.x2 = 0.5, -0.5
    for tick in range(12):
        wheel.phi = 0.3 * tick
        states.append((wheel.step(tick, 0.03, Params(), kick), wheel.x1, wheel.x2))
    return states


@pytest.mark.parametrize(
    ("name", "value", "shape"),
    [("k", 2.0, "rectangular"), ("shift_rad", 2.0, "smooth"), ("beta", 1.0, "smooth")],
)
def test_a_waveform_of_a_pulses_values_is_that_pulse(name, value, shape):
    pulse = ask(mode="pulse", param=name, value=value, ticks=5, shape=shape)
    values = [value * pulse_weight(age, 5, shape == "smooth") for age in range(5)]
    waveform = ask(mode="waveform", param=name, waveform=values)
    assert (waveform.ticks, waveform.begin) == (5, 3)
    assert run_wheel(waveform) == run_wheel(pulse)


def test_a_waveform_of_a_potential_adds_to_it_in_each_tick():
    twice = run_wheel(ask(mode="waveform", param="x2", waveform=[0.0, -0.7]))
    once = ask(mode="jump", variable="x2", delta=-0.7)
    once.begin = 4
    assert twice == run_wheel(once)


def test_the_longest_waveform_fits_into_frames_with_all_else():
    """A request and the snapshot, in which a kick stands beside the parameters."""
    longest = [-1.2345678901234567e-300] * MAX_WAVEFORM
    request = {"id": "x" * 64, "mode": "waveform", "param": "shift_rad", "waveform": longest}
    kick = parse(request, (1, 1), Params(), 0)
    event = {"event": "snapshot", "params": Params().values(), "kick": kick.as_dict()}
    for message in ({"id": 2**63, "do": "kick", "kick": request}, event):
        assert len(json.dumps(message)) < MAX_PAYLOAD - 500


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
