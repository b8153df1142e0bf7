"""The table of parameters: what it accepts, and that a change is whole or none."""

import json
from math import inf, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot.errors import Refused
from robot.params import LONGEST_STEP_TICKS, TABLE, Params, accepted, check_value, describe

values = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.floats(0.0, 100.0),
    st.text(max_size=9),
    st.lists(st.integers()),
)
changes = st.dictionaries(
    st.sampled_from((*TABLE, "speed", "")),
    values | st.sampled_from((1, -1, 2, "stop", "hold", 0.05, 8.0)),
    max_size=4,
)


def test_the_defaults_pass_their_own_checks():
    params = Params()
    assert params.check(params.values()) == dict(params.values())
    assert [row["name"] for row in json.loads(json.dumps(describe()))] == list(TABLE)


@given(changes | values, st.booleans())
def test_a_change_is_refused_or_leaves_sound_values_and_checking_changes_nothing(wanted, at_rest):
    params = Params()
    before = dict(params.values())
    try:
        checked = params.check(wanted, at_rest)
    except Refused as refusal:
        assert refusal.message
        checked = {}
    assert dict(params.values()) == before
    params.apply(checked)
    after = params.values()
    assert {name: type(value) for name, value in after.items()} == {
        name: type(value) for name, value in before.items()
    }
    for name, row in TABLE.items():
        assert (
            after[name] in row.choices if row.choices else row.minimum <= after[name] <= row.maximum
        )
    assert after["tau_s"] >= LONGEST_STEP_TICKS * after["tick_s"] - 1e-9


@pytest.mark.parametrize(
    "row", [row for row in TABLE.values() if row.choices is None], ids=lambda row: row.name
)
@pytest.mark.parametrize("value", [nan, inf, -inf, True, "8", None, [8], 10**400])
def test_a_number_out_of_range_or_of_another_kind_is_refused(row, value):
    with pytest.raises(Refused) as refused:
        check_value(row.name, value)
    assert refused.value.code == "range"


@pytest.mark.parametrize(
    "row", [row for row in TABLE.values() if row.choices is None], ids=lambda row: row.name
)
def test_the_ends_of_a_range_belong_to_it(row):
    assert check_value(row.name, row.minimum) == row.minimum
    assert check_value(row.name, row.maximum) == row.maximum
    for beyond in (row.minimum - 1e-6, row.maximum + 1e-6):
        with pytest.raises(Refused):
            check_value(row.name, beyond)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("rods", 3),
        ("rods", True),
        ("rods", 1.5),
        ("polarity_left", 0),
        ("link_loss", "run"),
        ("link_loss", ["stop"]),
    ],
)
def test_a_choice_that_is_none_is_refused(name, value):
    with pytest.raises(Refused):
        check_value(name, value)


def test_a_choice_comes_out_in_its_own_type():
    assert type(check_value("rods", 1.0)) is int


def test_one_wrong_value_refuses_all():
    params = Params()
    with pytest.raises(Refused):
        params.check({"k": 2.0, "a": nan})
    with pytest.raises(Refused) as refused:
        params.check({"k": 2.0, "speed": 1.0})
    assert refused.value.code == "unknown"
    assert params.k == 8.0


@pytest.mark.parametrize("wanted", [None, [], {}, "k=8", 8])
def test_no_change_at_all_is_refused(wanted):
    with pytest.raises(Refused) as refused:
        Params().check(wanted)
    assert refused.value.code == "usage"


def test_polarity_changes_at_rest_only_and_repeating_it_is_no_change():
    params = Params()
    assert params.check({"polarity_left": 1}, at_rest=False) == {"polarity_left": 1}
    with pytest.raises(Refused) as refused:
        params.check({"polarity_left": -1}, at_rest=False)
    assert refused.value.code == "state"
    assert params.check({"polarity_left": -1}, at_rest=True) == {"polarity_left": -1}


def test_no_euler_step_can_overshoot():
    params = Params()
    for wanted in ({"tau_s": 0.08}, {"tick_s": 0.1}, {"tick_s": 0.05, "tau_s": 0.1}):
        with pytest.raises(Refused):
            params.check(wanted)
    assert params.check({"tick_s": 0.1, "tau_s": 0.3}) == {"tick_s": 0.1, "tau_s": 0.3}


@given(
    st.fixed_dictionaries(
        {
            "tick_s": st.floats(0.01, 0.1),
            "tau_s": st.floats(0.03, 10.0) | st.floats(0.03, 0.3),
            "rod_lag_s": st.floats(0.0, 0.02),
        }
    ),
    st.booleans(),
)
def test_what_is_accepted_is_taken_and_a_little_more_is_not(wanted, at_rest):
    params = Params()
    try:
        params.apply(params.check(wanted))
    except Refused:
        return
    for name, row in TABLE.items():
        taken = accepted(name, params.values(), at_rest)
        for value in taken:
            assert params.check({name: value}, at_rest) == {name: value}
        if row.choices is None:
            beyond = [taken[0] - 2e-4, taken[1] + 2e-4]
        else:
            beyond = set(row.choices) - set(taken)
        for value in beyond:
            with pytest.raises(Refused):
                params.check({name: value}, at_rest)


def test_the_rods_are_at_most_a_tick_behind():
    params = Params()
    assert params.rod_lag_s == 0.0
    for wanted in (
        {"rod_lag_s": 0.021},
        {"rod_lag_s": -0.001},
        {"rod_lag_s": 0.02, "tick_s": 0.015},
    ):
        with pytest.raises(Refused):
            params.check(wanted)
    params.apply(params.check({"rod_lag_s": 0.02}))
    with pytest.raises(Refused, match="longer than a tick"):
        params.check({"tick_s": 0.01})
    assert params.check({"tick_s": 0.01, "rod_lag_s": 0.01})
