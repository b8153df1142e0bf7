"""M4: limit cycles and the manifolds of the saddles."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from host.theory.analysis import manifolds
from host.theory.analysis.fixpoints import fixpoint
from host.theory.analysis.manifolds import basin_labels, stable_manifolds, unstable_manifolds
from host.theory.analysis.trajectories import SAMPLE_S, limit_cycle, phase_of_cycle, trajectory
from host.theory.engine.ensemble import advance
from host.theory.model.wheel import OMEGA, PHI, Wheel


@pytest.mark.parametrize(("k", "kind"), [(1.4, "S"), (1.65, "FB"), (1.85, "LLM"), (8.0, "LLM")])
def test_portraits_show_what_the_paper_shows(k, kind):
    assert phase_of_cycle(limit_cycle(Wheel(k=k))) == kind


def test_chaos_is_no_cycle():
    assert phase_of_cycle(limit_cycle(Wheel(k=15.0, tau=1.0))) == "C"


def test_a_limit_cycle_closes_and_attracts():
    wheel = Wheel(k=1.65)
    loop = limit_cycle(wheel)
    period = (len(loop) - 1) * SAMPLE_S
    assert np.abs(loop[-1] - loop[0]).max() < 0.06
    start = loop[0] + np.array([0.0, 0.0, 0.05, 0.0])
    later = advance(start[:, None], wheel.columns(1), 60 * period)[:, 0]
    swings = [np.ptp(trajectory(state, wheel, period)[:, PHI]) for state in (start, later)]
    assert abs(swings[1] - np.ptp(loop[:, PHI])) < 0.3 * abs(swings[0] - np.ptp(loop[:, PHI]))


def test_the_unstable_manifold_leaves_the_saddle_as_its_eigenvalue_says_and_symmetrically():
    wheel = Wheel(k=1.85)
    rate = fixpoint(-pi / 4, wheel).eigenvalues[0].real
    branches = unstable_manifolds(-pi / 4, wheel, 4.0)
    away = np.log(np.abs(branches[0, :, PHI] + pi / 4))
    early = (away > np.log(1e-4)) & (away < np.log(1e-2))
    slope = np.polyfit(np.flatnonzero(early) * SAMPLE_S, away[early], 1)[0]
    assert slope == pytest.approx(rate, rel=1e-2)
    assert branches[0, :, PHI] + branches[1, :, PHI] == pytest.approx(-pi / 2, abs=1e-9)
    assert branches[0, :, OMEGA] == pytest.approx(-branches[1, :, OMEGA], abs=1e-9)


def test_wheels_on_either_side_of_a_stable_manifold_end_on_different_attractors():
    wheel = Wheel(k=1.65)
    phi, omega = stable_manifolds(wheel, 1.2)
    assert len(phi) > 240
    labels = {
        tuple(basin_labels(phi + dx, omega + dy, wheel))
        for dx, dy in ((1e-6, 0.0), (-1e-6, 0.0), (0.0, 1e-6), (0.0, -1e-6))
    }
    sides = np.array(list(labels))
    assert (np.ptp(sides, axis=0) > 0).all()
    # The saddle lies on the boundary of its basins.
    assert np.hypot(phi - pi / 4, omega).min() < 0.02


def test_boundaries_far_below_the_greatest_speed_are_found_as_finely_as_others(monkeypatch):
    """They reach 1.06 of 22 rad/s; a grid of half as many lines for all speeds has 60 points."""
    monkeypatch.setattr(manifolds, "GRID", 80)
    _, omega = stable_manifolds(Wheel(k=5.0), 22.0)
    assert omega.max() == pytest.approx(1.0636, abs=5e-4)
    assert len(omega) > 170
