"""The page for everybody: axe-core, keyboard alone, a narrow screen, less motion."""

import pytest
from axe_playwright_python.sync_playwright import Axe

from tests.web.test_basins import Halves

RULES = ["wcag2a", "wcag2aa", "wcag21aa", "wcag22aa"]
# Those of them that look at colours: in the dark all else is as in the light.
OF_COLOURS = ["color-contrast", "link-in-text-block"]
LOOKS = {"light": RULES, "dark": OF_COLOURS}


def assert_no_findings(page, rules=RULES):
    """Have axe-core look at the page as it is."""
    results = Axe().run(page, options={"runOnly": rules})
    assert results.response["passes"]
    assert results.violations_count == 0, results.generate_report()


@pytest.mark.parametrize(("scheme", "rules"), LOOKS.items(), ids=LOOKS)
def test_axe_finds_nothing_in_any_main_state(visit, lab, station, scheme, rules):
    station.basins = Halves()
    visitor = visit(color_scheme=scheme)
    visitor.until("r.basins")
    page = visitor.page
    page.click(".own summary")
    page.click("#parameters summary")
    page.click("#kick-phase")
    visitor.until("r.kicks.length === 1")
    assert_no_findings(page, rules)
    page.keyboard.press("Escape")
    visitor.until("r.state === 'stopped'")
    assert_no_findings(page, rules)
    station._link.loop.fail("the left motor does not answer")
    station.step(0.3)
    visitor.until("r.state === 'fault' && r.status.remedy === 'clear'")
    assert_no_findings(page, rules)
    watcher = visit(lab.view_url, color_scheme=scheme)
    watcher.page.wait_for_selector("#who-drives")
    assert_no_findings(watcher.page, rules)
    clock = station.clock
    station.clock = lambda: clock() + 30
    visitor.until("r.lost")
    assert_no_findings(page, rules)


def test_a_page_that_is_not_let_in_has_no_findings(visit, lab):
    visitor = visit()
    page = visitor.context.new_page()
    page.goto(lab.view_url + "not")
    page.wait_for_selector("text=Try again")
    assert_no_findings(page)


def press_until(page, key, condition):
    """Press a key until a condition on the focused element `e` holds."""
    for _ in range(80):
        if page.evaluate(f"(() => {{ const e = document.activeElement; return {condition}; }})()"):
            return
        page.keyboard.press(key)
    pytest.fail(f"no {key} leads to {condition}")


def test_the_keyboard_alone_guesses_kicks_stops_and_starts(visit, station):
    visitor = visit()
    page = visitor.page
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.textContent") == "Skip to the kicks"
    page.keyboard.press("Enter")
    press_until(page, "Tab", "e.name === 'guess'")
    press_until(page, "ArrowRight", "e.id === 'guess-0'")
    press_until(page, "Tab", "e.id === 'kick-phase'")
    page.keyboard.press("Enter")
    visitor.until("r.kicks.length === 1")
    station.step(2.5)
    page.keyboard.press("Escape")
    visitor.until("r.state === 'stopped'")
    press_until(page, "Shift+Tab", "e.className === 'remedy'")
    page.keyboard.press("Enter")
    station.step(0.3)
    visitor.until("r.state === 'running'")
    press_until(page, "Shift+Tab", "e.id === 'stop' || e.id === 'projector'")
    focus = page.evaluate("getComputedStyle(document.activeElement).outlineStyle")
    assert focus == "solid"


def test_nothing_scrolls_sideways(visit):
    page = visit(viewport={"width": 320, "height": 800}).page
    page.click(".own summary")
    page.click("#parameters summary")
    for width in (320, 390, 768, 1280, 1920):
        page.set_viewport_size({"width": width, "height": 800})
        assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_on_a_tablet_nothing_lies_over_start_after_a_stop(visit):
    visitor = visit(viewport={"width": 900, "height": 600})
    visitor.page.keyboard.press("Escape")
    visitor.reads("#stop-words", "Stopped.")
    visitor.page.click(".remedy", trial=True)


def test_the_first_screen_has_what_is_needed_most(visit):
    visitor = visit()
    for name in ("#left-wheel", "#right-wheel", "#lag-plane", "#strips", "#kick-phase", "#stop"):
        box = visitor.page.locator(name).bounding_box()
        assert box["y"] >= 0, name
        assert box["y"] + box["height"] <= 720, name


def test_kicks_and_stop_are_large_enough_for_a_thumb(visit):
    visitor = visit(viewport={"width": 390, "height": 844})
    for name in ("#kick-membrane", "#kick-position", "#kick-phase", "#stop"):
        box = visitor.page.locator(name).bounding_box()
        assert box["height"] >= 44, name
