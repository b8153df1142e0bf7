"""The lab's drawings in a real Chromium: what is where, and that nothing makes them throw."""

import json
from math import cos, hypot, pi, sin

import pytest

from tests.web.drawings import (
    BASINS,
    DRAWINGS,
    K_TRACE,
    KICKS,
    SCORE,
    STATES,
    WAVE,
    WHEEL,
    floor,
    open_page,
    plane,
    strips,
)

SMALL = {"width": 320, "height": 240}
LARGE = {"width": 1280, "height": 720}
SHARP = {"width": 400, "height": 300, "scale": 2}


@pytest.fixture(scope="module")
def page(browser):
    """A page that has the drawings."""
    page = open_page(browser)
    yield page
    page.close()


def _draw(page, name, state, **size):
    """Draw, and return a number that tells pictures apart."""
    return page.evaluate("([name, state, size]) => draw(name, state, size)", [name, state, size])


def _added(page, name, before, after, **size):
    """The pixels, (x, y), that a state draws otherwise than the one before."""
    places = page.evaluate(
        "([name, before, after, size]) => drawnOnto(name, before, after, size)",
        [name, before, after, size],
    )
    return {(x, y) for x, y in json.loads(places)}


def _colour(page, name):
    return page.evaluate("(name) => drawn.theme.colours[name]", name)


def _pixel(page, x, y):
    return page.evaluate("([x, y]) => pixel(x, y)", [x, y])


def _places(page, colour):
    """Where a picture has a colour of the theme, or nearly so, device pixels."""
    return json.loads(page.evaluate("(name) => places(drawn.theme.colours[name])", colour))


@pytest.mark.parametrize("look", [{}, {"dark": True}, {"projector": True}])
@pytest.mark.parametrize("size", [SMALL, LARGE, SHARP])
@pytest.mark.parametrize("name", DRAWINGS)
def test_whatever_is_known_is_drawn(page, name, size, look):
    empty = _draw(page, name, {}, **size, **look)
    pictures = [_draw(page, name, state, **size, **look) for state in STATES[name]]
    assert any(picture != empty for picture in pictures)


@pytest.mark.parametrize("name", DRAWINGS)
def test_the_same_state_is_the_same_picture(page, name):
    for state in STATES[name]:
        assert _draw(page, name, state, **SMALL) == page.evaluate("again()")


@pytest.mark.parametrize("name", DRAWINGS)
def test_what_is_out_of_date_is_grey(page, name):
    state = {"wheel": WHEEL, "strips": strips(left_x1=WAVE), "plane": plane(WAVE, WAVE)}
    state |= {"floor": floor(WAVE, WAVE), "score": SCORE, "basins": BASINS}
    state |= {"k_trace": K_TRACE}
    _draw(page, name, {**state[name], "stale": True}, **LARGE)
    assert page.evaluate("colourful()") == "[]"


def _wheel_at(page, right, up):
    """A place beside the wheel's axle in its radii, in CSS pixels."""
    at = page.evaluate("drawn.module.layout(drawn.canvas, drawn.theme)")
    return at["x"] + right * at["radius"], at["y"] - up * at["radius"]


@pytest.mark.parametrize("size", [SMALL, LARGE, SHARP])
@pytest.mark.parametrize(
    ("phi", "targets"), [(0.4, (-0.7, 0.9)), (3.0, (0.6, -0.8)), (4.5, (0, 0))]
)
def test_the_wheels_marks_are_where_the_positions_are(page, size, phi, targets):
    moved = {"phi_rad": phi, "target1": targets[0], "target2": targets[1], "torque": 0.0}
    _draw(page, "wheel", {**WHEEL, **moved}, **size)
    rail, spring = page.evaluate("[drawn.module.RAIL, drawn.module.SPRING]")
    for place, colour in (
        ((rail + targets[0], -spring), "target"),
        ((spring, targets[1] - rail), "target"),
        ((rail + cos(phi), 0), "actual"),
        ((0, sin(phi) - rail), "actual"),
        ((cos(phi), sin(phi)), "actual"),
    ):
        assert _pixel(page, *_wheel_at(page, *place)) == _colour(page, colour)


@pytest.mark.parametrize(("torque", "forward"), [(0.9, True), (-0.9, False)])
def test_a_positive_torque_points_counterclockwise(page, torque, forward):
    _draw(page, "wheel", {**WHEEL, "phi_rad": 0.0, "torque": torque}, **LARGE)
    for height in (0.5, 0.86):  # its shaft, its head
        above = _pixel(page, *_wheel_at(page, 1, height)) == _colour(page, "force")
        below = _pixel(page, *_wheel_at(page, 1, -height)) == _colour(page, "force")
        assert (above, below) == (forward, not forward)


def test_the_memory_lies_where_the_potentials_are(page):
    _draw(page, "wheel", {**WHEEL, "x1": -0.6, "x2": 0.1}, **LARGE)
    assert _pixel(page, *_wheel_at(page, -0.6, 0.1)) == _colour(page, "memory")


def _ghost_pixels(page, seen):
    """How many of the pixels are orange on a circle around the first seen position."""
    rail = page.evaluate("drawn.module.RAIL")
    x, y = _wheel_at(page, rail + seen, 0)
    places = _places(page, "actual")
    return sum(hypot(px - x, py - y) < 30 for px, py in places)


def test_ghosts_appear_only_while_a_quenched_kick_acts(page):
    seen = {"seen1": cos(1.0 + 3 * pi / 4), "seen2": sin(1.0 + 3 * pi / 4)}
    _draw(page, "wheel", {**WHEEL, "kick": "phase", **seen}, **LARGE)
    assert _ghost_pixels(page, seen["seen1"]) > 20
    plain = _draw(page, "wheel", WHEEL, **LARGE)
    assert _ghost_pixels(page, seen["seen1"]) == 0
    assert _draw(page, "wheel", {**WHEEL, **seen}, **LARGE) == plain
    _draw(page, "wheel", {**WHEEL, "kick": "membrane"}, **LARGE)
    assert _ghost_pixels(page, seen["seen1"]) == 0


@pytest.mark.parametrize("width", [200, 220, 400])
def test_no_word_is_cut_at_an_edge(page, width):
    without = {**WHEEL, "labels": {}}
    words = _added(page, "wheel", without, WHEEL, width=width, height=width)
    columns = {x for x, _ in words}
    assert min(columns) >= 1
    assert max(columns) < width - 1
    beside = []
    for kick in ("", "a"):
        _draw(page, "wheel", {**WHEEL, "kick": kick}, width=width, height=width)
        faint = _places(page, "faint")
        beside.append([at for at in faint if at[0] < 0.2 * width or at[1] < 0.45 * width])
    assert beside[0] == beside[1]  # the frame of a kick covers no word


def test_a_kick_is_named_and_framed(page):
    pictures = {_draw(page, "wheel", {**WHEEL, "kick": kick}, **LARGE) for kick in ("", "a", "b")}
    assert len(pictures) == 3
    assert _pixel(page, 1, 360) == _colour(page, "kick")


def test_a_spike_of_one_tick_is_as_high_as_a_lasting_one(page):
    flat, spike, high = [0.0] * 6000, [0.0] * 6000, [1.0] * 6000
    spike[3000] = 1.0
    states = [strips(6000, left_x1=course) for course in (flat, spike, high)]
    short = _added(page, "strips", states[0], states[1], **SHARP)
    long = _added(page, "strips", states[0], states[2], **SHARP)
    assert min(y for _, y in short) == pytest.approx(min(y for _, y in long), abs=2)
    assert len({x for x, _ in short}) < 10


# So many that each has its pixels, and so many that they share them.
FEW, MANY = 640, 2560


@pytest.mark.parametrize("count", [FEW, MANY])
def test_a_ring_is_drawn_from_its_start(page, count):
    wave = [sin(number / 8) for number in range(count)]
    straight = strips(count, left_x1=wave, left_torque=wave)
    turned = {**straight, "start": 256}
    turned["columns"] = {
        name: values[-256:] + values[:-256] for name, values in straight["columns"].items()
    }
    assert _draw(page, "strips", turned, **LARGE) == _draw(page, "strips", straight, **LARGE)
    loop = plane(wave, wave)
    rolled = {**plane(wave[-256:] + wave[:-256], wave[-256:] + wave[:-256]), "start": 256}
    assert _draw(page, "plane", rolled, **LARGE) == _draw(page, "plane", loop, **LARGE)


@pytest.mark.parametrize("count", [FEW, MANY])
def test_no_line_bridges_lost_records(page, count):
    half = count // 2
    state = strips(count, left_x1=[-0.8] * half + [0.8] * half)
    times = [(n + (half if n >= half else 0)) / 100 for n in range(count)]
    state["columns"]["t_s"] = times
    state["now_s"] = state["seconds"] = times[-1]
    without = {**state, "columns": {"t_s": times}}
    line = _added(page, "strips", without, state, **LARGE)
    columns = {x for x, _ in line}
    assert columns > {*range(50, 400), *range(900, 1260)}
    assert not columns & set(range(480, 830))
    # Nor does it climb where records begin again.
    rows = {y for _, y in line}
    assert len(rows) < 10


def test_the_newest_record_is_at_the_right_edge(page):
    flat = strips(left_x1=[0.0] * 600)
    late = strips(left_x1=[0.0] * 540 + [0.9] * 60)
    columns = {x for x, _ in _added(page, "strips", flat, late, **LARGE)}
    left, right = min(columns), max(columns)
    assert right > 1270
    assert (right - left) / 60 == pytest.approx((right - 39) / 600, rel=0.05)


@pytest.mark.parametrize("count", [60, 6000])
def test_what_is_not_known_leaves_no_mark(page, count):
    nothing = _draw(page, "strips", strips(count), **LARGE)
    assert _draw(page, "strips", strips(count, left_x1=[float("nan")] * count), **LARGE) == nothing


def test_a_kick_is_a_band_as_long_as_it_acts(page):
    state = {**strips(left_x1=WAVE), "kicks": KICKS[1:]}
    kick = {"begin_s": 2.0, "end_s": 3.0, "name": "phase"}
    band = _added(page, "strips", state, {**state, "kicks": [kick, *KICKS[1:]]}, **LARGE)
    columns = {x for x, y in band if 300 < y < 600}
    assert max(columns) - min(columns) == pytest.approx(1233 / 5.99, abs=2)
    assert columns == set(range(min(columns), max(columns) + 1))


def test_names_of_kicks_do_not_overlap(page):
    state = strips(left_x1=WAVE)
    near = [{"begin_s": 3.0 + n / 10, "end_s": 3.03 + n / 10, "name": "phase"} for n in range(2)]
    names = []
    for kicks in (near[1:], near):
        _draw(page, "strips", {**state, "kicks": kicks}, **LARGE)
        names.append({(x, y) for x, y in _places(page, "kick") if y < 13})
    assert names[0]
    assert names[0] == names[1]


def test_a_wrapped_angle_draws_no_line_across(page):
    x = [(0.3 * n - 1.8) % (2 * pi) for n in range(10)]
    state = plane(x, [0.5] * 10)
    trace = {px for px, _ in _added(page, "plane", {**state, "count": 0}, state, **LARGE)}
    # From edge to edge of the box, and nothing between.
    assert trace > {*range(50, 100), *range(1150, 1260)}
    assert not trace & set(range(300, 800))


def test_only_a_jump_is_joined_by_dots(page):
    x, y = [1.0] * 20 + [4.0] * 20, [0.5] * 20 + [-0.5] * 20
    jumped = [float(n == 20) for n in range(40)]
    _draw(page, "plane", plane(x, y, jumped=jumped), **LARGE)
    dots = {px for px, _ in _places(page, "kick")}
    between = set(range(min(dots), max(dots)))
    assert len(between) > 400
    assert len(between - dots) > 100
    _draw(page, "plane", plane(x, y), **LARGE)
    assert _places(page, "kick") == []


def test_the_ghost_is_drawn_where_the_state_seems_to_be(page):
    x, y = [1.0] * 5, [0.0] * 5
    plain = _draw(page, "plane", plane(x, y), **LARGE)
    right = max(px for px, _ in _places(page, "actual"))
    ghostly = plane(x, y, ghost={"x": 1.0 + pi, "y": 0.0})
    assert _draw(page, "plane", ghostly, **LARGE) != plain
    assert max(px for px, _ in _places(page, "actual")) > right + 500


def test_older_parts_of_a_trace_are_fainter(page):
    x = [0.5 + 0.05 * n for n in range(100)]
    _draw(page, "plane", plane(x, [0.0] * 100), **LARGE)

    def blue(column):
        """How bright the line is there; it has no blue."""
        return min(int(_pixel(page, column, y)[5:], 16) for y in range(340, 372))

    assert blue(700) > blue(1000) + 30


def test_the_floors_view_does_not_follow_every_step(page):
    _draw(page, "floor", floor([0.0], [0.0]), **LARGE)
    spans = page.evaluate(
        """() => [...Array(50).keys()].map((n) => {
            const { state } = drawn;
            [state.x_m, state.y_m] = [[0, 0.08 * n], [0, 0.02 * n]];
            [state.heading_rad, state.count] = [[0, 0], 2];
            drawn.module.draw(drawn.canvas, state, drawn.theme);
            return state.view.span;
        })"""
    )
    assert spans == sorted(spans)
    assert spans[-1] > 2
    assert len(set(spans)) < 6


def test_the_robot_points_where_its_heading_says(page):
    def nose(heading):
        _draw(page, "floor", floor([0.0], [0.0], heading_rad=[heading]), **LARGE)
        places = _places(page, "actual")
        return [sum(part) / len(places) for part in zip(*places, strict=True)]

    assert nose(0.0)[0] > 640 + 10
    assert nose(pi / 2)[1] < 360 - 10
    assert nose(pi)[0] < 640 - 10


def test_walls_stand_at_half_their_distance(page):
    view = {"x": 0, "y": 0, "span": 1.2}
    none = floor([0.0], [0.0], view=view)
    walls = _added(page, "floor", none, {**none, "walls": 1.0, "view": view}, **LARGE)
    inner = min(abs(x - 640) for x, _ in walls)
    assert inner == pytest.approx(0.5 * 720 / 1.2, abs=2)


def test_shares_are_as_wide_as_their_numbers(page):
    [wheel] = SCORE["wheels"][:1]
    open_yet = {**SCORE, "wheels": [{**wheel, "shares": None, "outcome": None}]}
    _draw(page, "score", {**SCORE, "wheels": [wheel]}, **LARGE)
    solid = [x for x, y in _places(page, "reverses") if y > 100]
    bar = _added(page, "score", open_yet, {**SCORE, "wheels": [wheel]}, **LARGE)
    whole = max(x for x, y in bar if y > 100) - min(solid)
    assert (max(solid) - min(solid)) / whole == pytest.approx(24 / 32, abs=0.02)


def test_guess_and_outcome_are_marked(page):
    marked = {"guess": "stops", "wheels": [{**SCORE["wheels"][0], "outcome": "reverses"}]}
    plain = {"guess": None, "wheels": [{**SCORE["wheels"][0], "outcome": None}]}
    marks = _added(page, "score", {**SCORE, **plain}, {**SCORE, **marked}, **LARGE)
    assert min(x for x, y in marks if y < 374) > 1100
    assert max(x for x, y in marks if y > 374) < 700


def test_ends_differ_without_their_colours(page):
    def grey(letter):
        return _draw(page, "basins", {"side": 2, "ends": 4 * letter, "stale": True}, **SMALL)

    assert len({grey(letter) for letter in "fbrn"}) == 4


def test_a_line_parts_basins_where_they_meet(page):
    # The first row is the lowest.
    _draw(page, "basins", {"side": 4, "ends": "ffff" * 3 + "bbbb"}, **SHARP)
    across = [y for x, y in _places(page, "ink") if x == 401]
    assert across
    assert all(abs(y - 150) <= 1 for y in across)


def test_k_raised_and_lowered_differ_by_marks_too(page):
    def picture(up, stale):
        first, second = K_TRACE["holds"][:2]
        state = {**K_TRACE, "holds": [first, {**second, "up": up}], "stale": stale}
        return _draw(page, "k_trace", state, **SHARP)

    assert picture(True, stale=True) != picture(False, stale=True)
    picture(True, stale=False)
    box = [x for x, y in _places(page, "raised") if y < 500]  # above the key
    picture(False, stale=False)
    assert min(x for x, y in _places(page, "lowered") if y < 500) == pytest.approx(min(box), abs=2)
    # k = 0.5 is a quarter of the axis, which ends at 2.
    left, right = 2 * 3.4 * 13, 800 - 2 * 13
    assert min(box) == pytest.approx(left + 0.25 * (right - left), abs=16)
