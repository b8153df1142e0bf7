"""Poincare sections and the study `section`, against scipy's events and closed forms."""

from math import pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from host.errors import NotDone
from host.perform.run import perform
from host.theory.analysis import power, sections
from host.theory.analysis.branches import rotation_by_formula
from host.theory.engine.crossings import crossings
from host.theory.engine.flow import FINENESS
from host.theory.model.wheel import Wheel
from host.theory.studies import section
from host.theory.studies.section_pieces import follow_wheels, settle_longer
from tests.paper.theory import independent

CHAOTIC, ROLLING, SWINGING = Wheel(k=15.0, tau=1.0), Wheel(k=8.0), Wheel(k=1.65)
SURFACES = {"phi": lambda _, y: np.sin(2 * y[2]), "omega": lambda _, y: y[3]}
START = np.array([1.0, 0.2, 0.3, 2.0])


@pytest.fixture(scope="module")
def settled():
    """What wheels that roll and swing do after 100 s, by the wheel."""
    wheels = [ROLLING, SWINGING]
    states = np.array([independent.turning(ROLLING), [1.0, 0.0, 0.3, 0.0]]).T
    return dict(zip(wheels, follow_wheels(wheels, states, 100.0, "phi", FINENESS), strict=True))


@pytest.mark.parametrize("surface", SURFACES)
def test_moments_are_those_of_scipys_events(surface):
    exact = independent.follow(START, CHAOTIC, 4.0, SURFACES[surface], rtol=3e-14)
    found = crossings(START[:, None], CHAOTIC.columns(1), 4.0, surface)
    assert len(found.times_s[0]) == len(exact.t_events[0]) >= 4
    assert found.times_s[0] == pytest.approx(exact.t_events[0], abs=1e-10)
    assert found.states[0] == pytest.approx(exact.y_events[0], abs=1e-9)
    assert found.ended[:, 0] == pytest.approx(exact.y[:, -1], abs=1e-9)


def test_a_wheel_that_turns_round_just_behind_the_section_crosses_it_twice_in_a_step():
    turns = np.array([1.0, 0.3, 1e-5, 0.0])  # the second rod pulls it back
    before = independent.last(turns, CHAOTIC, -0.004)
    found = crossings(before[:, None], CHAOTIC.columns(1), 0.02, "phi", fineness=0.5)
    assert before[2] < 0.0
    first, second = found.times_s[0]
    assert 0.0 < first < 0.004 < second < 0.008
    assert found.states[0][:, 2] == pytest.approx(0.0, abs=1e-14)


def test_wheels_that_differ_by_a_symmetry_have_the_same_points():
    x1, x2, phi, omega = START
    others = [START, (-x2, x1, phi + pi / 2, omega), (x1, -x2, -phi, -omega)]
    for surface in SURFACES:
        found = crossings(np.array(others).T, CHAOTIC.columns(3), 3.0, surface)
        first, *rest = (
            sections.points(times_s, states, CHAOTIC, surface)
            for times_s, states in zip(found.times_s, found.states, strict=True)
        )
        for one in rest:
            assert one.states == pytest.approx(first.states, abs=1e-9)


def test_a_rotation_is_a_fixpoint_and_so_is_a_swing(settled):
    rolls, swings = settled[ROLLING], settled[SWINGING]
    state, quarter_s = independent.rotation(ROLLING, independent.turning(ROLLING))
    assert rolls.motion.kind == "rolling"
    assert rolls.motion.repeat[:3] == (1, pytest.approx(4 * quarter_s, rel=1e-8), 4)
    assert rolls.points.states[-1] == pytest.approx(state, abs=1e-8)
    assert rotation_by_formula(ROLLING).unknowns[2] == pytest.approx(state[3], rel=1e-9)

    def forward(_, y):
        return y[2]

    forward.direction = 1.0
    later = independent.follow(swings.ended, SWINGING, 6.0, forward, rtol=1e-10).t_events[0]
    assert swings.motion.kind == "forth-and-back"
    assert swings.motion.repeat.crossings == 1
    assert swings.motion.repeat.period_s == pytest.approx(later[1] - later[0], rel=1e-6)


def test_a_wheel_that_does_not_repeat_itself_or_never_crosses(settled):
    chaotic, rests, rolls = (
        follow_wheels([wheel], state[:, None], 60.0, surface, FINENESS)[0].motion
        for wheel, state, surface in (
            (CHAOTIC, START, "phi"),
            (ROLLING._replace(k=1.0), np.array([1.0, 0.0, 0.0, 0.0]), "phi"),
            (ROLLING, settled[ROLLING].ended, "omega"),
        )
    )
    assert chaotic is None
    assert (rests.kind, rests.repeat) == ("at rest", None)
    assert (rolls.kind, rolls.repeat.crossings) == ("rolling", 0)
    assert rolls.repeat.period_s == pytest.approx(settled[ROLLING].motion.repeat.period_s)


NUMBER = np.arange(200.0)


@pytest.mark.parametrize(
    ("tau", "exponent", "sizes", "kind"),
    [
        (1.0, 0.8, 0.3 + 0.1 * np.cos(2.0 * NUMBER), "chaotic"),
        (1.0, 0.001, 0.3 + 0.1 * np.cos(2.0 * NUMBER), "quasi-periodic"),
        # Rest is stable up to tau = 0.115329 s. Its rate is -0.0041/s at 0.11506 s.
        (0.11506, -0.0041, 0.02 * 0.99**NUMBER, "at rest"),
        (0.11506, -0.0041, 0.3 + 0.1 * np.cos(2.0 * NUMBER), "quasi-periodic"),
        (0.11506, -0.0001, 0.3 + 0.1 * 0.99**NUMBER, "undecided"),
        (0.11534, -0.0004, 0.02 * 0.99**NUMBER, "undecided"),
        (0.11534, 0.0002, 0.02 * 1.001**NUMBER, "undecided"),
    ],
)
def test_what_a_wheel_is_that_does_not_repeat_itself(tau, exponent, sizes, kind):
    states = np.zeros((len(NUMBER), 4))
    states[:, 3] = sizes
    alike = np.zeros(len(NUMBER), dtype=int)
    found = sections.Points(NUMBER, states, alike, alike.astype(bool))
    assert sections.irregular(found, exponent, Wheel(k=3.0, tau=tau)).kind == kind


def test_a_wheel_just_below_the_hopf_bifurcation_comes_to_rest():
    wheel = Wheel(k=3.0, tau=0.11506)
    start = np.array([[1.0], [0.0], [0.0], [0.4]])
    settled = follow_wheels([wheel], start, 100.0, "phi", FINENESS)
    (found,) = settle_longer([wheel], settled, "phi", FINENESS)
    assert found["kind"] == "at rest"


def test_without_springs_there_is_no_rotation_to_search_for():
    with pytest.raises(NotDone, match="without springs"):
        rotation_by_formula(ROLLING._replace(k=0.0))


def test_powers_of_a_cycle_are_its_mean_squares(settled):
    state, period_s = settled[SWINGING].ended, settled[SWINGING].motion.repeat.period_s
    found = power.of_cycle(SWINGING, state, period_s)

    def squares(_, y):
        x1, x2, _, omega = y[:4]
        rates = independent.rates(y[:4], SWINGING)
        return [*rates, x1, x2, x1**2 + x2**2, omega**2]

    end = solve_ivp(squares, (0.0, period_s), [*state, 0, 0, 0, 0], "DOP853", rtol=1e-9).y[4:, -1]
    mean = end / period_s
    assert found.frequency_hz[:2] * period_s == pytest.approx([1.0, 2.0])
    assert found.omega.sum() == pytest.approx(mean[3], rel=1e-6)
    assert found.potentials.sum() == pytest.approx(mean[2] - mean[0] ** 2 - mean[1] ** 2, rel=1e-6)


def test_a_density_holds_the_power_and_has_its_peak_at_the_frequency(settled):
    ended, hertz = settled[ROLLING].ended, 1.0 / settled[ROLLING].motion.repeat.period_s
    found = power.of_motion(ROLLING, ended[:, None], 60.0)
    cycle = power.of_cycle(ROLLING, ended, 1.0 / hertz)
    apart = found.frequency_hz[0]
    assert found.potentials.sum() * apart == pytest.approx(cycle.potentials.sum(), rel=1e-3)
    strongest = power.peaks(found.frequency_hz, found.potentials, 1)[0]
    assert strongest.frequency_hz == pytest.approx(hertz, abs=0.1 * apart)


def test_the_study_prints_motions_peaks_and_the_rotation(tmp_path, monkeypatch):
    for name, value in {"WHEELS": 2, "SETTLE_S": 50.0, "SWINGS": 1.0}.items():
        monkeypatch.setattr(section, name, value)
    summary = perform("section", None, 1, out=tmp_path, k=8.0, tau=0.25, seconds=10.0)
    numbers = summary["numbers"]
    (motion,), (spectrum,) = numbers["motions"], numbers["spectra"]
    hertz = numbers["rotation"]["frequency_hz"]
    assert summary["unwritten"] == {}
    assert (motion["kind"], motion["period"], motion["wheels"]) == ("rolling", 1, 4)
    assert spectrum["cycle_hz"] == pytest.approx(hertz, rel=1e-6)
    assert spectrum["potentials"][0]["frequency_hz"] == pytest.approx(hertz, rel=1e-6)
    assert spectrum["omega"][0]["frequency_hz"] == pytest.approx(4 * hertz, rel=1e-6)
    assert numbers["times_off_by_s"] < 1e-10
    assert "sin(2 phi) = 0" in summary["answers"][0]["value"]
