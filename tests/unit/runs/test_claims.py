"""Claims and their three verdicts, as objects, as plain data, in words, and as an exit status."""

import json

import pytest

from host.runs.claims import Claim, exit_status, too_few
from host.runs.contract import Setting

VERDICTS = {True: "holds", False: "does not hold", None: "undecided"}


def claim(holds, **fields):
    return Claim("R8", "it reverses", "always", 0.5, "Hz", (0.4, 0.6), holds, **fields)


@pytest.mark.parametrize("holds", VERDICTS)
def test_plain_data_has_the_verdict_beside_holds_and_comes_back(holds):
    data = json.loads(json.dumps(claim(holds).as_dict()))
    assert (data["holds"], data["verdict"]) == (holds, VERDICTS[holds])
    assert Claim.from_dict(data) == claim(holds)


def test_a_claim_that_does_not_hold_stands_out_in_its_sentence():
    sentence = claim(True, note="the mean of 9 wheels").sentence()
    measured = "Measured: 0.5 Hz (0.4 to 0.6), the mean of 9 wheels."
    assert sentence == f"R8 holds: it reverses. {measured} Asked for: always."
    assert claim(False).sentence().startswith("R8 DOES NOT HOLD: ")
    assert claim(None).sentence().startswith("R8 undecided: ")


@pytest.mark.parametrize("holds", VERDICTS)
def test_a_reason_to_doubt_makes_it_undecided_and_is_noted(holds):
    doubted = claim(holds, note="25 of 50").doubted("", "too short", "too weak")
    assert doubted.holds is None
    assert doubted.note == "25 of 50; too short; too weak"
    assert claim(holds).doubted("too short").note == "too short"
    assert claim(holds).doubted("") == claim(holds).doubted() == claim(holds)


@pytest.mark.parametrize(
    ("holds", "status"),
    [
        ([], 0),
        ([True, None], 0),
        ([None], 0),
        ([True, None, False], 1),
    ],
)
def test_only_a_claim_that_does_not_hold_is_a_failure(holds, status):
    assert exit_status([claim(one).as_dict() for one in holds]) == status


def test_too_few_says_how_many_it_takes():
    assert too_few(20, 20, "kicks") == ""
    assert too_few(3, 20, "kicks") == "3 kicks are too few: it takes 20 to decide"


def test_a_run_elsewhere_names_the_parameters_of_the_claim_and_its_own():
    setting = Setting(1, {"a": 3.0, "tau": 0.25, "k": None})
    assert setting.elsewhere(tau=0.25, k=None) == ""
    assert setting.elsewhere(a=4.0, tau=0.25) == "the claim is made for a = 4 (here 3)"
    assert "k = 8 (here None)" in setting.elsewhere(k=8.0)


def test_another_motor_or_battery_is_elsewhere_and_the_nominal_voltage_is_not():
    for own in (Setting(1, {}), Setting(1, {}, battery_v=7.5)):
        assert own.elsewhere() == ""
    assert "motor = pybricks (here nxt_unroller)" in Setting(1, {}, "nxt_unroller").elsewhere()
    assert "battery = 7.5 V (here 6 V)" in Setting(1, {}, battery_v=6.0).elsewhere()


def test_a_short_run_says_what_it_would_take():
    setting = Setting(1, {"seconds": 3.0, "seeds": 2, "to": None})
    assert setting.short_of(seconds=3.0, seeds=2, to=20.0) == ""
    assert setting.short_of(seconds=60.0, seeds=3) == (
        "to decide takes seconds = 60 or more (here 3), seeds = 3 or more (here 2)"
    )
