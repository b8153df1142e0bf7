"""Lines in the plane of two constants, against scipy, away from the study's own grid."""

import numpy as np
import pytest

from host.errors import NotDone
from host.figures.theory import lines as figure
from host.runs.contract import Setting
from host.runs.registry import complete_options
from host.theory.analysis import windows
from host.theory.analysis.attractors import random_starts
from host.theory.analysis.boundaries import Boundary
from host.theory.analysis.chaos_edges import MANY, chaos_edges, crisis_beside
from host.theory.analysis.cycle_lines import Window
from host.theory.analysis.hopf import above_hopf
from host.theory.analysis.sections import points, repeat
from host.theory.analysis.transients import lives
from host.theory.engine.crossings import crossings
from host.theory.model.wheel import Wheel
from host.theory.studies import lines, lines_boundaries, lines_cycles, lines_windows
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
    end = independent.last(y, wheel, seconds)
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
def window_lines():
    """The lines of a window between tau = 1.19 and 1.27 s, from a cycle in it."""
    plane = Plane(PAPER, "k", "tau", Window(15.5, 18.5, 0.5, 1.27))
    cycle = np.array([-0.055878, -0.321172, 15.124829, 2.461785, 17.33871])
    with pytest.MonkeyPatch.context() as patch:
        known = [(windows.family_of(10, -4, False), cycle)]
        patch.setattr(windows, "attracting_cycles", lambda *_: known)
        return lines_windows.window_rows(0, plane, np.random.default_rng(1))


def test_wheels_come_to_a_cycle_of_six_crossings_that_the_mirror_closes():
    found = windows.attracting_cycles(
        PAPER._replace(tau=1.5), "k", np.array([9.3, 9.5, 9.7]), np.random.default_rng(1)
    )
    assert {family.name for family, _ in found} == {"6 crossings, -3 quarter turns, mirrored"}
    for family, (x1, x2, omega, seconds, k) in found:
        start = np.array([x1, x2, 0.0, omega])
        end = independent.last(start, PAPER._replace(tau=1.5, k=k), seconds)
        assert family.back @ (end - [0.0, 0.0, family.turn, 0.0]) == pytest.approx(start, abs=1e-4)


def doublings(rows, y):
    """The period doublings of the cycles of ten crossings at an y, in ascending order of k."""
    return sorted(
        {
            row["x"]: row for row in at_edge(rows, "period-doubling", y) if row["crossings"] == 10
        }.items()
    )


@pytest.mark.parametrize("y", [1.27 * 31 / 32, 1.27 * 15 / 16])
def test_scipy_has_the_cycle_of_ten_crossings_and_a_multiplier_minus_1(window_lines, y):
    found = doublings(window_lines, y)
    assert len(found) == 2
    for k, row in found:
        wheel = PAPER._replace(k=k, tau=y)
        start = np.array([row["x1"], row["x2"], 0.0, row["omega"]])
        end = independent.last(start, wheel, row["period"])
        end[2] -= row["quarters"] * np.pi / 2
        assert row["quarters"] % 4 == 0
        assert end == pytest.approx(start, abs=1e-7)
        leading = independent.multipliers(start, row["period"], wheel, np.eye(4))[0]
        assert leading == pytest.approx(-1.0, abs=1e-6)


def test_a_cycle_and_its_images_are_one_cycle(window_lines):
    y = 1.27 * 31 / 32
    k, row = doublings(window_lines, y)[-1]
    wheel = PAPER._replace(k=k, tau=y)
    start = np.array([row["x1"], row["x2"], 0.0, row["omega"]])
    quarter_behind = independent.UNDO_QUARTER @ start - [0.0, 0.0, np.pi / 2, 0.0]
    images = np.array([start, MIRROR @ start, quarter_behind]).T
    found = crossings(images, wheel.columns(3), 3 * row["period"])
    cycles = [
        windows.cycle_of(points(times_s, states, wheel, "phi"), 10, k)
        for times_s, states in zip(found.times_s, found.states, strict=True)
    ]
    for family, unknowns in cycles:
        assert (family.name, family.power) == (f"10 crossings, {row['quarters']} quarter turns", 1)
        assert unknowns == pytest.approx(cycles[0][1], abs=1e-6)
        assert unknowns[3] == pytest.approx(row["period"], abs=1e-6)


def test_a_wheel_doubles_its_period_where_the_line_says_so(window_lines):
    y = 1.27 * 31 / 32
    k, row = doublings(window_lines, y)[-1]
    wheels = PAPER._replace(tau=y).columns(2, k=np.array([0.999 * k, 1.001 * k]))
    starts = np.array([row["x1"], row["x2"], 0.0, row["omega"]])[:, None] * [1.001, 1.001]
    found = crossings(starts, wheels, 400.0)
    lengths = []
    for times_s, states in zip(found.times_s, found.states, strict=True):
        own = points(times_s[-200:], states[-200:], PAPER._replace(tau=y), "phi")
        lengths.append(repeat(own).crossings)
    assert lengths == [10, 20]


def test_a_fold_beside_the_merging_line_is_reported_with_its_distance(monkeypatch):
    plane = Plane(PAPER, "a", "k", Window(0.8, 0.9, 4.9, 5.0))
    cycle = np.array([0.99080039, -0.09852007, 0.41285559, 21.62581847, 0.83902268, 5.0])

    def found(part, wheel, *_):
        return [lines_cycles._Crossing("fold", cycle)] if wheel.k == 5.0 else []

    monkeypatch.setattr(lines_cycles, "_crossings", found)
    (row,) = cycle_rows("FB", plane)
    assert (row["kind"], row["type"], row["on"]) == ("end", "beside", "fold")
    assert 0.0 < row["gap"] < 1e-8
    rows = [{"part": "FB", "band": 0, **row}]
    found = lines.report(rows, Setting(1, options(x="a", y="k")))
    answer = found.answers[0]
    assert answer.name.startswith("folds of forth-and-back cycles: so close to the merging line")
    assert answer.value.endswith(f"closer than {row['gap']:.1e} of it")
    beside, missed = found.numbers["not_drawn"]
    assert beside == f"{answer.name}: {answer.value}"
    assert missed == (
        "windows that may be missing: those narrower in a than 0.05, or lower in k than 1.2"
    )


@pytest.fixture(scope="module")
def edges():
    return chaos_edges(PAPER._replace(tau=1.0), "k", 6.0, np.random.default_rng(1))


def test_below_the_crisis_wheels_stop_turning_round_and_above_it_they_do_not(edges):
    (edge,) = edges
    assert edge.side == "lower"
    assert edge.leaves < edge.value < edge.stays < 1.01 * edge.leaves
    ks = np.repeat([0.95 * edge.leaves, 1.01 * edge.stays], 8)
    parameters = PAPER._replace(tau=1.0).columns(16, k=ks)
    ended = lives(random_starts(16, np.random.default_rng(2)), parameters, 400.0, 1.0).ended
    assert ended[:8].all()
    assert not ended[8:].all()


def test_the_upper_crisis_mirrors_the_lower_one():
    """Wheels leave below 0.3 and above 0.7; only the way of the bisection matters."""

    def leaving(value):
        return MANY if not 0.3 < value < 0.7 else 1 if not 0.31 < value < 0.69 else 0

    values = np.linspace(0.05, 1.0, 20).tolist()
    for side, place, leaves, stays in (("lower", 6, 0.3, 0.31), ("upper", 12, 0.7, 0.69)):
        found = crisis_beside(side, leaving, values, place)
        assert found.side == side
        assert (found.leaves, found.stays) == pytest.approx((leaves, stays), abs=1e-3)
        assert found.value == pytest.approx((leaves + stays) / 2, abs=1e-3)
    assert crisis_beside("upper", leaving, values[:12], 11) is None
    assert crisis_beside("lower", lambda _: 1, values, 6) is None


def test_there_is_no_edge_where_there_is_no_chaos():
    assert chaos_edges(PAPER, "k", 4.0, np.random.default_rng(1)) == []


def test_the_lines_are_reported_and_drawn(cycles, window_lines, edges, tmp_path):
    setting = Setting(1, options(y_to=0.83))
    plane = plane_of(setting.options)
    rows = [{"part": part, "band": 0, **row} for part, own in cycles.items() for row in own]
    hopf = boundary_rows("Hopf", plane)
    rows += [{"part": "Hopf", "band": 0, **row} for row in hopf]
    cell = {"part": "phases", "first": 0}
    rows += [{**cell, **row} for row in lines.simulate(cell, setting)]
    rows += [{"part": "windows", "band": 0, **row} for row in window_lines]
    crisis = dict(zip(("side", "x", "leaves", "stays"), edges[0], strict=True))
    rows.append({"part": "chaos", "number": 0, "kind": "chaos", "y": 0.5, **crisis})
    found = lines.report(rows, setting)
    names = [one["line"] for one in found.numbers["lines"]]
    assert "Neimark-Sacker line of rotations" in names
    assert "period doublings of cycles in windows" in names
    assert any(one.name == "chaos lasts above, tau = 0.5 s" for one in found.answers)
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
