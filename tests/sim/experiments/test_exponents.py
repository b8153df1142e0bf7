"""The experiment `exponents`: chaotic and regular places, for the robot and for the model."""

import pytest

from host.errors import WrongUse
from host.experiments.robot import exponents
from host.experiments.robot.exponents import FRESH, KS, MODEL, TAUS_S, WHOSE
from host.figures.robot.exponents import draw
from host.runs.contract import Setting

SETTING = Setting(1, {"pairs": 12})
OLDER = list(WHOSE)[1]


def rates(whose, tau_s, monkeypatch, *ks):
    monkeypatch.setattr(exponents, "KS", ks)
    return exponents.simulate({"whose": whose, "tau_s": tau_s}, SETTING)


def test_the_robot_is_chaotic_with_older_rods_and_regular_at_its_defaults(monkeypatch):
    (chaos,) = rates(OLDER, 1.0, monkeypatch, 15.0)
    assert chaos["low"] > 0.5
    (regular,) = rates(OLDER, 0.25, monkeypatch, 8.0)
    assert regular["exponent"] < 0.2
    (fresh,) = rates(FRESH, 1.0, monkeypatch, 15.0)
    assert fresh["exponent"] < 0.2


def test_the_models_exponent_is_that_of_the_study_of_its_plane(monkeypatch):
    """0.87/s at k = 15 and tau = 1 s (claim M8), and 0 where it rolls."""
    chaos, rest = rates(MODEL, 1.0, monkeypatch, 15.0, 0.1)
    assert chaos["exponent"] == pytest.approx(0.87, abs=0.15)
    assert rest["exponent"] < 0


def test_a_figure_shows_every_place():
    rows = [
        {"whose": whose, "tau_s": tau_s, "k": k, "exponent": 0.5, "low": 0.4, "high": 0.6}
        for whose in WHOSE
        for tau_s in TAUS_S
        for k in KS
    ]
    findings = exponents.report(rows, SETTING)
    assert len(findings.numbers["chaotic"]) == len(rows)
    figure = draw(rows, findings)
    assert [len(axes.texts) for axes in figure.axes] == [len(KS) * len(TAUS_S)] * len(WHOSE)


def test_a_real_robot_is_refused_in_words():
    with pytest.raises(WrongUse, match="simulated robot"):
        exponents.cells(SETTING.options, batch=False)
