"""What is drawn when: nothing as long as nothing changes, and never an old picture."""

import pytest

from tests.web.test_basins import Halves

# Which drawings are in view, and which of them become others if all are drawn anew, as happens when
# one has lost its pixels.
OLD = """
    async () => {
        const frame = () => new Promise(requestAnimationFrame);
        const seen = [...document.querySelectorAll("canvas")].filter((canvas) => {
            const { top, bottom, width } = canvas.getBoundingClientRect();
            return width && bottom > 0 && top < innerHeight;
        });
        const pictures = () => seen.map((canvas) => canvas.toDataURL());
        for (let n = 0; n < 4; n += 1) await frame();
        const before = pictures();
        seen[0].width = 0;
        for (let n = 0; n < 2; n += 1) await frame();
        const after = pictures();
        const name = ({ id, ariaLabel }) => id || ariaLabel;
        return {
            all: seen.map(name),
            old: seen.filter((_, n) => before[n] !== after[n]).map(name),
        };
    }
"""
# How many of some frames had something drawn.
DRAWN = """
    async (frames) => {
        const drawn = () => lab.state().drawing.frames;
        const before = drawn();
        for (let n = 0; n < frames; n += 1) await new Promise(requestAnimationFrame);
        return drawn() - before;
    }
"""

# What the lab says makes a page draw anew, too: a page that hears nothing shows what it draws by
# itself.
DEAF = """
    const { set } = Object.getOwnPropertyDescriptor(WebSocket.prototype, "onmessage");
    Object.defineProperty(WebSocket.prototype, "onmessage", {
        set(take) {
            set.call(this, (event) => window.deaf || take(event));
        },
    });
"""

CHANGES = {
    "dark": lambda page: page.emulate_media(color_scheme="dark"),
    "a projector": lambda page: page.click("#projector"),
    "a smaller window": lambda page: page.set_viewport_size({"width": 1000, "height": 600}),
    "what is further down": lambda page: page.locator("#k-plane").scroll_into_view_if_needed(),
    "no basins": lambda page: page.click("#basins-switch"),
}


@pytest.fixture
def page(visit, station):
    """The page of a robot that stands still in time, with basins. It hears nothing any more."""
    station.basins = Halves()
    visitor = visit(script=DEAF)
    visitor.until("r.basins")
    visitor.page.evaluate("window.deaf = true")
    return visitor.page


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_what_changes_while_the_robot_stands_is_drawn(page, change):
    change(page)
    found = page.evaluate(OLD)
    assert len(found["all"]) > 1
    assert found["old"] == []


def test_a_robot_that_does_not_answer_is_drawn_grey(visit, station):
    visitor = visit()
    clock = station.clock
    station.clock = lambda: clock() + 30
    visitor.until("r.lost")
    found = visitor.page.evaluate(OLD)
    assert "left-wheel" in found["all"]
    assert found["old"] == []


def test_little_is_drawn_while_a_robot_stands_and_all_as_it_moves(visit, station):
    visitor = visit()
    visitor.page.evaluate(DRAWN, 10)
    # What the lab says now and then, as that the robot is still there, may be seen.
    assert visitor.page.evaluate(DRAWN, 40) < 20
    drawn = visitor.state()["drawing"]["frames"]
    station.step(0.1)
    visitor.until(f"s.drawing.frames > {drawn} && s.drawing.shown_s > r.record.t_s - 0.05")
    assert visitor.page.evaluate(OLD)["old"] == []
