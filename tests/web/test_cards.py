"""What the cards of robots and their twins say, and whether it has room."""

import pytest

from host.lab.live_twin import LiveTwin
from host.lab.station import CONTINUE
from host.lab.stepped_station import SteppedStation
from tests.web.test_basins import Halves
from tests.web.test_beside import STATES, card, robot, show  # noqa: F401 - a fixture

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


class Own(SteppedStation):
    """A robot whose basins are not computed by the lab."""

    basins = property(lambda self: self.halves, lambda self, worker: None)


def test_a_plane_without_basins_says_why(show):  # noqa: F811
    anna = Own("sim://?seed=1", "anna", CONTINUE, LiveTwin())
    bert = Own("sim://?seed=2", "bert", CONTINUE, LiveTwin())
    anna.halves, bert.halves = Halves(), Halves()
    anna.halves.waits = True
    visitor = show(anna, bert, viewport={"width": 1366, "height": 768})
    notes = "s.beside.cards.map((one) => one.note).join()"
    twin, other = "a twin has no basins", "basins once chosen"
    visitor.until(f"{notes} === 'basins: computing …,{twin},{other},{twin}'")
    visitor.page.click("[aria-label=bert] .choose")
    visitor.until("s.robots[1].basins")
    visitor.until(f"{notes} === '{other},{twin},a slice,{twin}'")
    visitor.page.click("[aria-label=anna] .choose")
    visitor.until(f"{notes} === 'basins: computing …,{twin},a slice,{twin}'")
    label = card(visitor, "Twin of anna").locator(".plane canvas").get_attribute("aria-label")
    assert label.endswith("A twin has no basins.")
    visitor.page.evaluate("document.querySelector('#basins-switch').click()")
    visitor.until(f"{notes} === 'a slice,a slice,a slice,a slice'")


def test_cards_that_do_not_fit_say_that_there_are_more(show):  # noqa: F811
    stations = [robot(n, name, LiveTwin()) for n, name in ((1, "anna"), (2, "bert"))]
    visitor = show(*stations, viewport={"width": 1280, "height": 800})
    page = visitor.page
    assert page.is_hidden("text=More below")
    page.click("#projector")
    page.wait_for_selector("html.projector")
    last = page.locator(".card >> nth=3")
    page.wait_for_selector("text=More below")
    lowest = page.locator(".below").bounding_box()
    assert lowest["y"] + lowest["height"] <= 800
    assert last.bounding_box()["y"] + last.bounding_box()["height"] > 800
    page.click("text=More below")
    page.wait_for_selector("text=More below", state="hidden")
    assert last.bounding_box()["y"] + last.bounding_box()["height"] <= 800
    page.click("#projector")
    page.wait_for_selector("html:not(.projector)")
    assert page.is_hidden("text=More below")


@pytest.mark.parametrize("width", [360, 1280, 1920])
def test_one_key_below_all_cards_says_what_their_colours_are(show, width):  # noqa: F811
    anna, bert = (
        Own(f"sim://?seed={n}", name, CONTINUE) for n, name in enumerate(("anna", "bert"))
    )
    anna.halves, bert.halves = Halves(), Halves()
    bert.halves.waits = True
    visitor = show(anna, bert, viewport={"width": width, "height": max(640, 9 * width // 16)})
    page = visitor.page
    key = page.locator(".first > .key")
    marks = ["target", "actual", "seen in a kick", "force", "memory"]
    visitor.until("s.robots[0].basins")
    page.wait_for_selector(".first > .key > .forward")
    shown = key.locator("li:visible")
    assert shown.all_inner_texts() == [*marks, "forward", "backward", "rest"]
    box = key.bounding_box()
    assert box["x"] >= 0
    assert box["x"] + box["width"] <= width
    if width > 1000:  # all of it is on the first screen
        assert box["y"] + box["height"] <= page.viewport_size["height"]
    page.click("[aria-label=bert] .choose")
    page.wait_for_selector(".first > .key > .forward", state="hidden")
    assert shown.all_inner_texts() == marks
    page.click("#beside-switch")
    page.wait_for_selector(".first > .key", state="hidden")
