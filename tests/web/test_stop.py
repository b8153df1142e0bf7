"""STOP on the lab's page: by Esc and Space wherever the focus is, and by the button."""

import pytest

from host.lab.observed import ASKED_S

FOCUS = {
    "nowhere": lambda page: page.click("h1"),
    "a number": lambda page: page.click("#param-k"),
    "a slider": lambda page: page.click("input[aria-label=k]"),
    "a choice": lambda page: page.click("#guess-0"),
    "a fold": lambda page: page.click(".own summary"),
    "a kick": lambda page: page.click("#kick-membrane"),
}


def rolls(visitor, station):
    station.step(0.3)
    visitor.until("r.state === 'running'")


@pytest.mark.parametrize("focus", FOCUS)
def test_a_key_stops_wherever_a_click_has_left_the_focus(visit, station, focus):
    visitor = visit()
    for key in ("Escape", " "):
        rolls(visitor, station)
        FOCUS[focus](visitor.page)
        kicks = visitor.page.evaluate("document.activeElement.closest('.kick') !== null")
        assert not kicks, key
        visitor.page.keyboard.press(key)
        visitor.until("r.state === 'stopped' && s.stop.anna === 'confirmed'")
        visitor.reads("#stop-words", "Stopped. The robot confirms it.")
        visitor.page.click(".remedy")


def test_space_does_what_a_control_does_if_the_keyboard_led_there(visit, station):
    visitor = visit()
    rolls(visitor, station)
    visitor.page.click("#guess-3")
    while visitor.page.evaluate("document.activeElement.id") != "kick-membrane":
        visitor.page.keyboard.press("Tab")
    visitor.page.keyboard.press(" ")
    visitor.until("r.kicks.length === 1")
    assert visitor.robot()["state"] == "running"
    visitor.page.keyboard.press("Escape")
    visitor.until("r.state === 'stopped'")


def test_who_only_watches_stops_too(visit, lab, station):
    visitor = visit(lab.view_url)
    rolls(visitor, station)
    colour = "getComputedStyle(document.querySelector('#stop')).backgroundColor"
    seen = visitor.page.evaluate(colour)
    visitor.page.hover("#stop")
    assert visitor.page.evaluate(colour) == seen  # red, also under the mouse
    visitor.page.click("#stop")
    visitor.until("r.state === 'stopped'")


def test_without_a_link_it_says_so_and_stops_when_it_is_back(visit, lab, station, begin_again):
    visitor = visit()
    rolls(visitor, station)
    lab.__exit__(None, None, None)
    visitor.until("!s.link.up")
    visitor.page.keyboard.press("Escape")
    visitor.until("s.stop.anna === 'waiting'")
    begin_again()
    visitor.until("s.stop.anna === 'confirmed' && r.state === 'stopped'")
    visitor.forgive("WebSocket connection to")


@pytest.mark.parametrize("pressed", ["while there is no link", "once it is refused"])
def test_a_page_that_is_refused_says_that_it_stops_nothing(
    visit, lab, station, begin_again, pressed
):
    visitor = visit()
    rolls(visitor, station)
    lab.__exit__(None, None, None)
    visitor.until("!s.link.up")
    if pressed == "while there is no link":
        visitor.page.keyboard.press("Escape")
        visitor.until("s.stop.anna === 'waiting'")
    keys = dict(vars(lab.keys))
    vars(lab.keys).update({name: f"{key}-new" for name, key in keys.items()})
    again = begin_again()
    visitor.until("s.refused")
    if pressed == "once it is refused":
        visitor.page.keyboard.press("Escape")
    visitor.until("s.stop.anna === 'refused'")
    visitor.reads("#stop-words", "This page cannot stop anything.")
    vars(again.keys).update(keys)  # nothing is owed to a page that is let in later
    visitor.page.click("text=Try again")
    visitor.until("s.link.up && r && !s.stop.anna")
    rolls(visitor, station)
    assert visitor.page.locator("#stop-words").inner_text() == ""
    visitor.forgive("WebSocket connection to")


def test_a_page_that_was_never_let_in_says_that_it_stops_nothing(visit, lab):
    page = visit().context.new_page()
    page.goto(lab.view_url + "not")
    page.wait_for_selector("text=Try again")
    page.keyboard.press("Escape")
    page.wait_for_selector("#stop-words.alarm >> text=This page cannot stop anything.")


def test_it_is_not_confirmed_by_a_robot_that_is_away(visit, station):
    visitor = visit()
    rolls(visitor, station)
    station.stop = lambda: None
    visitor.page.keyboard.press("Escape")
    visitor.until("s.stop.anna === 'unconfirmed'")
    visitor.reads("#stop-words", "NOT confirmed")


def test_it_is_confirmed_over_a_new_link_too(visit, lab, station, begin_again):
    visitor = visit()
    rolls(visitor, station)
    for _ in range(60):  # much is heard of the robot before the link is lost
        tick = visitor.robot()["record"]["tick"]
        station.step(0.03)
        visitor.until(f"r.record.tick > {tick}")
    stop, station.stop = station.stop, lambda: None
    visitor.page.keyboard.press("Escape")
    visitor.until("s.stop.anna === 'unconfirmed'")
    lab.__exit__(None, None, None)
    visitor.until("!s.link.up")
    begin_again()
    visitor.until("s.link.up")
    stop()
    station.step(0.1)
    visitor.until("s.stop.anna === 'confirmed'")
    visitor.forgive("WebSocket connection to")


# At which steps down the page a click on the middle of STOP meets STOP.
REACHED = """
    () => {
        const stop = document.getElementById("stop"), seen = [];
        const steps = Math.ceil(document.documentElement.scrollHeight / innerHeight);
        for (let step = 0; step <= steps; step += 1) {
            scrollTo(0, step * innerHeight);
            const box = stop.getBoundingClientRect();
            const middle = [box.x + box.width / 2, box.y + box.height / 2];
            const top = document.elementFromPoint(...middle);
            seen.push(box.height >= 44 && box.width >= 44 && stop.contains(top));
        }
        return seen;
    }
"""


def test_the_button_is_in_view_at_every_place_of_the_page(visit):
    page = visit(viewport={"width": 320, "height": 568}).page
    for size in ((320, 568), (390, 844), (844, 390), (1280, 720), (1920, 1080)):
        page.set_viewport_size({"width": size[0], "height": size[1]})
        reached = page.evaluate(REACHED)
        assert len(reached) > 1, size
        assert all(reached), size


def test_it_says_who_has_stopped_the_robot(visit, lab, station):
    one, two = visit(), visit(lab.view_url)
    rolls(one, station)
    two.page.keyboard.press("Escape")
    two.reads("#now .reason", "This page stopped it.")
    one.reads("#now .reason", "Another page of this lab (2) stopped it.")
    one.page.get_by_role("button", name="Start", exact=True).first.click()
    rolls(one, station)
    station.step(ASKED_S)
    with station._lock:  # somebody else's program, of the same person
        station._robot.stop_at_once()
        station._robot.pump(0.0)
    one.reads("#now .reason", "stopped it from the computer")
