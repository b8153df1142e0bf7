"""Lines in the plane of two constants, against scipy, away from the study's own grid."""

import numpy as np
import pytest

from host.errors import NotDone
from host.figures.theory import lines as figure
from host.runs.contract import Setting
from host.runs.registry import complete_options
from host.theory.analysis.attractors import random_starts
from host.theory.analysis.boundaries import Boundary
from host.theory.analysis.chaos_edges import chaos_edges
from host.theory.analysis.cycle_lines import Window
from host.theory.analysis.hopf import above_hopf
from host.theory.analysis.transients import lives
from host.theory.model.wheel import Wheel
from host.theory.studies import lines, lines_boundaries
from host.theory.studies.lines_boundaries import boundary_rows
from host.theory.studies.lines_cycles import cycle_rows
from host.theory.studies.lines_plane import Plane, plane_of
from host.theory.studies.registry import TABLE
from tests.paper.theory import independent

PAPER = Wheel()
MIRROR = np.diag([1.0, -1.0, -1.0, -1.0])


def options(**own):
    return complete_options("lines", TABLE["lines"], own)


def at_edge(rows, type_, y):
    """The points of a line at an edge of its plane."""
    return [
        row
        for row in rows
        if row["kind"] == "point" and row["type"] == type_ and abs(row["y"] / y - 1) < 1e-9
    ]


@pytest.fixture(scope="module", autouse=True)
def few_values():
    """The planes of these tests are narrow."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lines_boundaries, "_TRIED", 12)
        yield


@pytest.fixture(scope="module")
def cycles():
    """The lines of cycles between tau = 0.82 and 0.83 s, close to the merging and far from it."""
    near, far = (
        Plane(PAPER, "k", "tau", Window(*ks, 0.82, 0.83)) for ks in ((0.55, 0.65), (5.7, 6.1))
    )
    return {
        "FB": cycle_rows("FB", near),
        "LLM": cycle_rows("LLM", near) + cycle_rows("LLM", far),
    }


@pytest.mark.parametrize(
    ("part", "type_", "multiplier", "back", "power"),
    [
        ("FB", "fold", 1.0, MIRROR, 2),
        ("LLM", "fold", 1.0, independent.UNDO_QUARTER, 4),
        ("LLM", "neimark-sacker", None, independent.UNDO_QUARTER, 4),
    ],
)
def test_scipy_has_the_same_cycle_and_a_multiplier_of_modulus_1(
    cycles, part, type_, multiplier, back, power
):
    (row,) = at_edge(cycles[part], type_, 0.83)
    wheel = PAPER._replace(k=row["x"], tau=row["y"])
    y = np.array([row["x1"], row["x2"], 0.0, row["omega"]])
    seconds = row["period"] / power
    end = independent.follow(y, wheel, seconds).y[:, -1]
    end[2] -= np.pi / 2 * (power == 4)
    assert back @ end == pytest.approx(y, abs=1e-7)
    leading = independent.multipliers(y, seconds, wheel, back)[0]
    if multiplier:  # twice, with that along the path: it is known to the root of scipy's error
        assert leading == pytest.approx(multiplier, abs=1e-4)
    else:
        assert abs(leading) == pytest.approx(1.0, abs=1e-8)
        assert leading.imag != 0.0


def passes_by_scipy(wheel):
    """Whether a wheel that leaves the saddle at -pi/4 reaches pi/2 before it turns back."""
    saddle = np.array([np.sqrt(0.5), -np.sqrt(0.5), -np.pi / 4, 0.0])
    values, vectors = np.linalg.eig(independent.jacobian(saddle, wheel))
    vector = vectors[:, values.real.argmax()].real

    def turned_back(_, y):
        return y[3]

    def passed(_, y):
        return y[2] - np.pi / 2

    turned_back.terminal = passed.terminal = True
    start = saddle + 1e-6 * vector / vector[2]
    events = (turned_back, passed)
    return len(independent.follow(start, wheel, 60.0, events).t_events[1]) > 0


@pytest.mark.parametrize(("axis", "value"), [("tau", 0.37), ("f", 0.62)])
def test_the_merging_line_lies_between_wheels_that_scipy_sees_turn_back_and_pass(axis, value):
    plane = Plane(PAPER, "k", axis, Window(1.0, 3.0, 0.99 * value, value))
    (row,) = at_edge(boundary_rows("merging", plane), "merging", value)
    there = plane.at(row["x"], value)
    assert [passes_by_scipy(there._replace(k=there.k * (1 + off))) for off in (-1e-9, 1e-9)] == [
        False,
        True,
    ]


def test_the_saddle_of_the_neutral_point_has_two_opposite_leading_eigenvalues():
    plane = Plane(PAPER, "k", "tau", Window(1.0, 1.2, 0.41, 0.42))
    (row,) = [row for row in boundary_rows("merging", plane) if row["kind"] == "special"]
    assert row["type"] == "neutral saddle"
    assert row["y"] == pytest.approx(0.41446, abs=5e-6)
    assert row["off_by"] < 1e-11
    saddle = np.array([np.sqrt(0.5), np.sqrt(0.5), np.pi / 4, 0.0])
    wheel = PAPER._replace(k=row["x"], tau=row["y"])
    leading = np.sort(np.linalg.eigvals(independent.jacobian(saddle, wheel)).real)[-2:]
    assert sum(leading) == pytest.approx(0.0, abs=1e-9)
    assert not passes_by_scipy(wheel._replace(k=wheel.k * (1 - 1e-9)))


def test_the_folds_of_swinging_end_where_cycles_cease_to_be_born_stable():
    plane = Plane(PAPER, "k", "tau", Window(0.33, 0.35, 1.42, 1.44))
    (bautin,) = [row for row in boundary_rows("Hopf", plane) if row["kind"] == "special"]
    assert bautin["y"] == pytest.approx(1.43435, abs=5e-6)
    rows = cycle_rows("FB", plane)
    assert [row["type"] for row in rows if row["kind"] == "end"] == ["Hopf line"]
    last = [row for row in rows if row["kind"] == "point"][-2:]
    # The fold line touches the Hopf line: its distance grows with the square of that to the point.
    far, near = (np.sqrt(above_hopf(plane.at(row["x"], row["y"]))) for row in last)
    touched = last[1]["y"] + (last[1]["y"] - last[0]["y"]) * near / (far - near)
    assert touched == pytest.approx(bautin["y"], abs=2e-5)


@pytest.fixture(scope="module")
def edges():
    return chaos_edges(PAPER._replace(tau=1.0), "k", 6.0, np.random.default_rng(1))


def test_below_the_edge_of_chaos_wheels_stop_turning_round_and_above_it_they_do_not(edges):
    (edge,) = edges
    assert edge.few < edge.value < edge.most
    assert edge.most - edge.few < 0.1 * edge.value
    ks = np.repeat([0.9 * edge.few, 1.1 * edge.most], 8)
    parameters = PAPER._replace(tau=1.0).columns(16, k=ks)
    ended = lives(random_starts(16, np.random.default_rng(2)), parameters, 400.0, 1.0).ended
    assert ended[:8].all()
    assert not ended[8:].all()


def test_there_is_no_edge_where_there_is_no_chaos():
    assert chaos_edges(PAPER, "k", 4.0, np.random.default_rng(1)) == []


def test_the_lines_are_reported_and_drawn(cycles, edges, tmp_path):
    setting = Setting(1, options(y_to=0.83))
    plane = plane_of(setting.options)
    rows = [{"part": part, "band": 0, **row} for part, own in cycles.items() for row in own]
    hopf = boundary_rows("Hopf", plane)
    rows += [{"part": "Hopf", "band": 0, **row} for row in hopf]
    cell = {"part": "phases", "first": 0}
    rows += [{**cell, **row} for row in lines.simulate(cell, setting)]
    chaos = {"part": "chaos", "number": 0, "kind": "chaos", "y": 0.5}
    few, most = edges[0].few, edges[0].most
    rows.append({**chaos, "x": edges[0].value, "few": few, "most": most})
    found = lines.report(rows, setting)
    names = [one["line"] for one in found.numbers["lines"]]
    assert "Neimark-Sacker line of rotations" in names
    assert found.numbers["axes"] == {"x": "k", "y": "tau"}
    figure.draw(rows, found).savefig(tmp_path / "lines.png")
    # Another way to the Hopf line: the greatest growth of rest vanishes.
    for row in hopf[:: len(hopf) // 3]:
        wheel = plane.at(row["x"], row["y"])
        values = np.linalg.eigvals(independent.jacobian(np.array([1.0, 0.0, 0.0, 0.0]), wheel))
        assert values.real.max() == pytest.approx(0.0, abs=1e-9 * abs(values).max())


def test_a_boundary_is_followed_around_a_fold_and_lost_where_it_ends():
    circle = Boundary(lambda point: float(point @ point) < 1.0)
    seen = []
    for point in circle.follow(np.array([1.0, 0.0]), np.array([0.0, 1.0]), 0.1):
        seen.append(point)
        if len(seen) > 40 and point[0] > 0.9:
            break
    assert min(point[0] for point in seen) < -0.99
    assert max(abs(np.linalg.norm(point) - 1.0) for point in seen) < 1e-13
    crossed = list(circle.crossings((np.array([-2.0, 0.5]), np.array([2.0, 0.5])), 20))
    assert crossed[0] == pytest.approx([-np.sqrt(0.75), 0.5])
    # A boundary that runs almost across the direction in which it is followed at first.
    slanted = Boundary(lambda point: bool(point[0] + 5 * point[1] < 0.0))
    _, following = zip(
        range(2), slanted.follow(np.zeros(2), np.array([0.0, -1.0]), 0.1), strict=False
    )
    assert following[1][0] == pytest.approx(-5 * following[1][1], rel=1e-9)
    half = Boundary(lambda point: bool(point[0] < 0.0 and point[1] < 0.5))
    with pytest.raises(NotDone, match="boundary"):
        for _ in half.follow(np.zeros(2), np.array([0.0, 1.0]), 0.1):
            pass
