"""What the cards of robots and their twins say, and whether it has room."""

import pytest

from host.lab.live_twin import LiveTwin
from tests.web.test_beside import STATES, robot, show  # noqa: F401 - a fixture

# What is wider than its place or than the window. Of what scrolls by itself, the scroller counts.
WIDE = """
    () => [...document.querySelectorAll("body, body *:not(canvas)")].filter((one) => {
        if (!one.checkVisibility() || one.closest(".unseen, .skip, h1, svg")) return false;
        if (one.matches(".screen, .first")) return false; // the panel of kicks has wider margins
        const box = one.getBoundingClientRect();
        const inner = one.clientWidth && one.scrollWidth > one.clientWidth + 1;
        return box.right > innerWidth + 0.5 || box.left < -0.5 || inner;
    }).map((one) => `${one.tagName} ${one.id} ${one.className}: ${one.scrollWidth}`)
"""
LONGEST = ("the_robot_of_the_third_group_of_class_11", "bert-with-an-even-longer-name-than-other")


@pytest.mark.parametrize("width", [320, 360, 1100, 1280, 1920])
def test_the_longest_names_wrap_and_nothing_scrolls_sideways(show, width):  # noqa: F811
    stations = [robot(n, name, LiveTwin()) for n, name in enumerate(LONGEST)]
    visitor = show(*stations, viewport={"width": width, "height": 9 * width // 16})
    page = visitor.page
    pressed = page.get_attribute("#projector", "aria-pressed") == "true"
    if width >= 1280 and not pressed:
        page.click("#projector")
    page.check("#kick-all")
    stations[1].stop()
    visitor.until(f"{STATES} === 'running,stopped'")
    for shown in ("beside", "large"):
        if shown == "large":
            page.click("#beside-switch")
            page.click(f"#robots >> text={LONGEST[1]}")
            page.wait_for_selector(f"#now .remedy[aria-label='Start: {LONGEST[1]}']")
            page.click("#stop")
            visitor.reads("#stop-words", "confirms it.")
        visitor.reads("#parameters-title", LONGEST[shown == "large"])
        assert page.evaluate(WIDE) == []
        assert page.evaluate("document.documentElement.scrollWidth") == width
        top = page.locator(".top").bounding_box()["height"]
        assert width < 700 or top < page.viewport_size["height"] / 2
