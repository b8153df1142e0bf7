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
# How many of some frames had something drawn, and how many messages came in them.
DRAWN = """
    async (frames) => {
        const now = () => [lab.state().drawing.frames, window.heard];
        const before = now();
        for (let n = 0; n < frames; n += 1) await new Promise(requestAnimationFrame);
        return now().map((count, n) => count - before[n]);
    }
"""

# What the lab says makes a page draw anew, too: a page that hears nothing shows what it draws by
# itself.
DEAF = """
    window.heard = 0;
    const { set } = Object.getOwnPropertyDescriptor(WebSocket.prototype, "onmessage");
    Object.defineProperty(WebSocket.prototype, "onmessage", {
        set(take) {
            set.call(this, (event) => {
                window.heard += 1;
                window.deaf?.includes(typeof event.data) || take(event);
            });
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
    visitor.page.evaluate("window.deaf = 'string, object'")
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
    visitor = visit(script=DEAF)
    visitor.page.evaluate(DRAWN, 10)
    # What the lab says now and then, as that the robot is still there, may be seen.
    drawn, heard = visitor.page.evaluate(DRAWN, 40)
    assert drawn <= heard + 1
    drawn = visitor.state()["drawing"]["frames"]
    station.step(0.1)
    visitor.until(f"s.drawing.frames > {drawn} && s.drawing.shown_s > r.record.t_s - 0.05")
    assert visitor.page.evaluate(OLD)["old"] == []


def test_what_records_alone_tell_is_drawn_as_they_end(visit, station):
    visitor = visit(script=DEAF)
    page = visitor.page
    page.locator("#k-plane").scroll_into_view_if_needed()
    page.evaluate(DRAWN, 10)
    page.evaluate("window.deaf = 'string'")
    assert page.evaluate("lab.state().k_trace[0].means.left") is None
    station.step(3.0)
    visitor.until("s.k_trace[0].means.left")
    page.evaluate(DRAWN, 10)
    found = page.evaluate(OLD)
    assert "k-plane" in found["all"]
    assert found["old"] == []
