"""What the page says of a lab that is dead."""

import pytest

# Whether all words of the alarm and STOP are in view, and nothing lies over them, at every place
# of the page.
ALARM_IS_SEEN = """() => {
    const words = document.querySelector(".notice.alarm p"), stop = document.getElementById("stop");
    const seen = (one) => {
        const { left, top, right, bottom } = one.getBoundingClientRect();
        const middle = document.elementFromPoint((left + right) / 2, (top + bottom) / 2);
        const inside = top >= 0 && left >= 0 && right <= innerWidth && bottom <= innerHeight;
        return inside && one.contains(middle);
    };
    const steps = Math.ceil(document.documentElement.scrollHeight / innerHeight), found = [];
    for (let step = 0; step <= steps; step += 1) {
        scrollTo(0, step * innerHeight);
        found.push(seen(stop) && seen(words));
    }
    return found;
}"""


@pytest.mark.parametrize("size", [(1280, 720), (900, 600), (320, 640)])
def test_a_dead_lab_is_seen_at_every_place_of_the_page(visit, lab, size):
    visitor = visit(viewport={"width": size[0], "height": size[1]})
    visitor.page.fill("#param-k", "7")
    visitor.page.keyboard.press("Enter")
    visitor.until("s.baton.you")
    lab.__exit__(None, None, None)
    visitor.until("!s.link.up")
    visitor.page.keyboard.press("Escape")
    visitor.until("s.stop.anna === 'waiting'")
    seen = visitor.page.evaluate(ALARM_IS_SEEN)
    assert len(seen) > 1
    assert all(seen)
    visitor.reads("#baton", "No link to the lab: this page does not know who drives.")
    assert "This page drives." not in visitor.page.inner_text("#baton")
    visitor.forgive("WebSocket connection to")
