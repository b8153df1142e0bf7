"""The least push that reverses a wheel, against bisection by scipy; the edge that it crosses."""

from math import cos, degrees, pi, radians, sin

import numpy as np
import pytest

from host.figures.theory.edge import draw
from host.runs.contract import Setting
from host.runs.registry import complete_options
from host.theory.analysis import edge, least_push
from host.theory.engine.kicked import memory_s
from host.theory.model.wheel import PHI, Wheel
from host.theory.studies import edge as study
from host.theory.studies.registry import TABLE
from tests.paper.theory import independent
from tests.paper.theory.table import rows_of

WHEEL = Wheel(k=8.0)
FEW = {
    "PHASES": 8,
    "DIRECTIONS": 12,
    "LEVELS": 8,
    "_AROUND": np.linspace(0.7, 1.1, 5),
    "_WITHIN": 1e-6,
}


@pytest.fixture(scope="module")
def cycle():
    return least_push.rolling(WHEEL)


@pytest.fixture(scope="module")
def least(cycle):
    with pytest.MonkeyPatch.context() as patched:
        for name, value in FEW.items():
            patched.setattr(least_push, name, value)
        return least_push.least(least_push.POTENTIALS, WHEEL, cycle)


@pytest.fixture(scope="module")
def path(least):
    return edge.track(WHEEL, least.below, least.above, 9.0)


@pytest.fixture(scope="module")
def rolled():
    """A wheel of another program that rolls forward: its course over a quarter turn, at phi = 0."""
    state = independent.last([0.0, 0.0, 0.0, 10.0], WHEEL, 12.0, rtol=1e-10)
    turns = independent.follow(state, WHEEL, 0.5, lambda _, y: sin(2 * y[2]), rtol=1e-11)
    crossed = next(y for y in turns.y_events[0] if round(y[2] / (pi / 2) % 4, 6) % 4 == 0)
    crossed[PHI] = 0.0
    return crossed


def pushed(rolled, phase_deg, direction_deg, amplitude):
    """Whether a wheel that is pushed at this phase reverses, by another program."""
    turned = independent.follow(
        rolled, WHEEL, 0.3, lambda _, y: y[2] - radians(phase_deg), rtol=1e-11
    )
    state = turned.y_events[0][0]
    state[0] += amplitude * cos(radians(direction_deg))
    state[1] += amplitude * sin(radians(direction_deg))
    return independent.last(state, WHEEL, 3.5, rtol=1e-9)[3] < 0.0


def phase_deg_of(least, cycle):
    return degrees(np.interp(least.moment, np.arange(least_push.MOMENTS), cycle[PHI]))


def test_the_least_jump_is_where_another_program_finds_it_by_bisection(least, cycle, rolled):
    place = phase_deg_of(least, cycle), degrees(least.angle)
    low, high = 0.98 * least.amplitude, 1.02 * least.amplitude
    assert not pushed(rolled, *place, low)
    assert pushed(rolled, *place, high)
    for _ in range(14):
        middle = (low + high) / 2
        low, high = (low, middle) if pushed(rolled, *place, middle) else (middle, high)
    assert least.amplitude == pytest.approx((low + high) / 2, abs=2e-6)
    assert least.error < 2e-6
    assert least.amplitude < 0.62 * 2 * np.hypot(*cycle[:2]).min()  # of the paper's inversion


def test_around_the_least_jump_no_smaller_one_reverses(least, cycle, rolled):
    phase_deg, direction_deg = phase_deg_of(least, cycle), degrees(least.angle)
    for later, turned in ((2.0, 0.0), (-2.0, 0.0), (0.0, 8.0), (0.0, -8.0), (20.0, 30.0)):
        assert not pushed(rolled, phase_deg + later, direction_deg + turned, least.amplitude)


def test_the_edge_leads_to_the_saddle_which_wheels_leave_at_its_own_rate(path):
    x1, x2, phi, omega = path.states[:, -1]
    assert phi % (pi / 2) == pytest.approx(pi / 4, abs=1e-3)
    assert (abs(x1), abs(x2), omega) == pytest.approx((cos(pi / 4), sin(pi / 4), 0.0), abs=1e-3)
    saddle = np.array([cos(pi / 4), sin(pi / 4), pi / 4, 0.0])
    growth = np.linalg.eigvals(independent.jacobian(saddle, WHEEL)).real.max()
    (times, forward), (_, backward) = edge.departures(WHEEL, path, 3.0)
    apart = np.abs(backward - forward).max(axis=0)
    linear = (apart > 1e-5) & (apart < 1e-3)
    assert np.polyfit(times[linear], np.log(apart[linear]), 1)[0] == pytest.approx(growth, rel=0.01)
    first = np.flatnonzero(apart > edge.PARTED)[0]
    assert times[-1] - times[first] == pytest.approx(3.0 * memory_s(WHEEL), rel=0.05)
    assert forward[3, -1] > 0.0 > backward[3, -1]


def test_moments_beyond_a_quarter_turn_are_those_of_the_next(cycle):
    """Pushes are turned with the wheel, so that a search may cross the seam."""
    last, first = (
        least_push.pushes(least_push.POTENTIALS, cycle, np.array([moment]), np.array([angle]))
        for moment, angle in ((least_push.MOMENTS, 2.0), (0, 2.0 - pi / 2))
    )
    assert np.array_equal(last.starts, first.starts)
    assert last.ways == pytest.approx(first.ways, abs=1e-15)


def test_the_study_answers_with_both_pushes_and_draws_them(cycle, least, path, monkeypatch):
    push = least._replace(amplitude=20.0, angle=pi)  # of the speed, about as it is
    for name, value in FEW.items():
        monkeypatch.setattr(least_push, name, value)
    monkeypatch.setattr(study, "PHASES", study.BAND)
    monkeypatch.setattr(study, "rolling", lambda wheel: cycle)
    monkeypatch.setattr(study, "least", lambda kind, *_: push if kind == "speed" else least)
    monkeypatch.setattr(study, "track", lambda *_: path)
    setting = Setting(0, complete_options("edge", TABLE["edge"], {}))
    rows = rows_of(study, setting)
    findings = study.report(rows, setting)
    potentials, speed = findings.numbers["pushes"]
    assert potentials["amplitude"] == least.amplitude
    assert potentials["amplitude"] <= potentials["map_least"] <= findings.numbers["x1_alone"]
    # A wheel must be stopped and driven back: that takes more than twice its speed.
    assert (speed["amplitude"], speed["direction_deg"]) == (20.0, 180.0)
    assert speed["map_least"] == pytest.approx(20.05, abs=1.0)
    assert speed["map_least"] > 2 * findings.numbers["rolling_omega"]
    state = findings.numbers["edge"]
    assert (state["rests"], state["kind"], round(state["phi_deg"])) == (True, "saddle", 45)
    assert "rest at 45°" in findings.answers[-1].value
    figure = draw(rows, findings)
    assert [len(axes.lines) for axes in figure.axes[:3]] == [1, 3, 4]
