"""The study `orbit`: its windows against closed forms and scipy, and how periods are told."""

import numpy as np
import pytest

from host.perform.run import perform
from host.runs.contract import Setting
from host.runs.registry import complete_options
from host.theory.analysis import sections
from host.theory.analysis.hopf import hopf
from host.theory.model.wheel import Wheel
from host.theory.studies import orbit
from host.theory.studies.registry import TABLE
from tests.paper.theory import independent

MERGING = 1.77731184665692  # by AUTO and by bisection


def section_points(x2):
    """Points on the section that differ in x2 only, one a second."""
    states = np.zeros((len(x2), 4))
    states[:, 1], states[:, 3] = x2, 1.0
    return sections.Points(
        np.arange(float(len(x2))),
        states,
        np.arange(len(x2)),
        np.zeros(len(x2), dtype=bool),
    )


def test_a_period_is_the_shortest_and_a_spiral_has_none_of_its_own():
    number = np.arange(90)
    doubled = sections.repeat(section_points(0.3 + 0.01 * (-1.0) ** number))
    assert (doubled.crossings, doubled.period_s, doubled.quarters) == (2, 4.0, 4)
    # Close to a Neimark-Sacker bifurcation with an angle of 120 degrees.
    spiral = section_points(0.3 + 3e-4 * 0.99**number * np.cos(2 * np.pi / 3 * number))
    assert sections.repeat(spiral) is None
    assert sections.repeat(spiral, settling=True).crossings == 1
    wide = section_points(0.3 + 0.01 * 0.99**number * np.cos(2 * np.pi / 3 * number))
    assert sections.repeat(wide) is sections.repeat(wide, settling=True) is None
    torus = section_points(0.3 + 0.05 * np.cos(2.0 * number))
    assert sections.repeat(torus, settling=True) is None


@pytest.fixture(scope="module")
def summary(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(orbit, "BAND", 3)
        given = {"tau": 0.25, "from": 1.3, "to": 2.1, "values": 5}
        return perform("orbit", None, 1, out=tmp_path_factory.mktemp("orbit"), **given)


def test_windows_are_rest_swings_and_rotations(summary):
    windows = summary["numbers"]["windows"]
    assert summary["unwritten"] == {}
    for way in ("up", "down"):
        rest, swings, rolls = (own for own in windows if own["way"] == way)
        assert [own["kind"] for own in (rest, swings, rolls)] == [
            "at rest",
            "forth-and-back",
            "rolling",
        ]
        assert [own["period"] for own in (rest, swings, rolls)] == [None, 1, 1]
        assert rest["to"] < hopf(Wheel()).k < swings["from"]
        assert swings["to"] < MERGING < rolls["from"]
        fastest = Wheel(k=rolls["to"])
        quarter_s = independent.rotation(fastest, independent.turning(fastest))[1]
        assert rolls["period_s"][1] == pytest.approx(4 * quarter_s, rel=1e-6)
    assert summary["numbers"]["coexistence"] == []


def test_the_answer_has_a_line_for_each_window(summary):
    names = [answer["name"] for answer in summary["answers"]]
    assert "up: at rest" in names
    assert "up: forth-and-back, period 1" in names  # of a single value
    assert "down: rolling, period 1" in names


def test_where_the_ways_differ_attractors_coexist():
    setting = Setting(1, complete_options("orbit", TABLE["orbit"], {}))
    kinds = {
        "up": ["rolling", "rolling", "chaotic", "at rest"],
        "down": ["rolling", "chaotic", "chaotic", "undecided"],
    }
    rows = [
        {
            "way": way,
            "first": 0,
            "value": float(value),
            "number": 0,
            "kind": kind,
            "period": 1 if kind == "rolling" else None,
            "period_s": 2.0 - 0.5 * value if kind == "rolling" else None,
            "exponent": None if kind == "rolling" else 0.5,
        }
        for way, own in kinds.items()
        for value, kind in enumerate(own)
    ]
    found = orbit.report(rows, setting)
    assert found.numbers["coexistence"] == [
        {"from": 1.0, "to": 1.0, "up": "rolling", "down": "chaotic"}
    ]
    first = found.numbers["windows"][0]
    assert (first["from"], first["to"], first["period_s"]) == (0.0, 1.0, [2.0, 1.5])
