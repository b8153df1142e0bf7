"""Several robots, and a robot and its twin, beside each other on the lab's page."""

from contextlib import ExitStack

import pytest

from host.lab.live_twin import LiveTwin
from host.lab.server import Lab
from host.lab.station import CONTINUE
from host.lab.stepped_station import SteppedStation
from tests.web.test_access import assert_no_findings, press_until
from tests.web.test_page import Forecast
from tests.web.visitor import Visitor

STATES = "s.robots.map((one) => one.state).join()"
READY = "r && s.beside.shown && s.beside.cards.every((one) => one.traced > 50)"
# The parts of the first screen that must be seen without scrolling.
SEEN = ".card canvas, .card .stop:not([hidden]), #stop, #kick-phase"


@pytest.fixture
def show(browser):
    """A function that opens a page on a lab with some robots."""
    with ExitStack() as stack:
        visitors = []

        def show(*stations, script="", ready=READY, **context):
            for station in stations:
                stack.callback(station.close)
                station.step(3.0)
            lab = stack.enter_context(Lab(stations, port=0))
            visitor = Visitor(browser, lab, lab.drive_url, script, **context)
            stack.callback(visitor.context.close)
            visitors.append(visitor)
            visitor.until(ready)
            return visitor

        yield show
        assert [words for visitor in visitors for words in visitor.complaints] == []


def robot(seed, name, twin=None):
    return SteppedStation(f"sim://?seed={seed}", name, CONTINUE, twin)


@pytest.fixture
def pair():
    """Two robots."""
    return robot(1, "anna"), robot(2, "bert")


def card(visitor, name):
    return visitor.page.locator(f".card[aria-label='{name}']")


def out_of_sight(page):
    """Which of the parts are cut by the window's edges, or are smaller than a thumb."""
    return page.evaluate(
        """(seen) => [...document.querySelectorAll(seen)].filter((one) => {
            const box = one.getBoundingClientRect();
            return box.top < 0 || box.bottom > innerHeight || box.right > innerWidth
                || box.height < 44;
        }).map((one) => one.outerHTML)""",
        SEEN,
    )


def test_a_kick_goes_to_the_chosen_robot_and_each_stop_to_its_own(show, pair):
    _, bert = pair
    visitor = show(*pair, viewport={"width": 1366, "height": 768})
    page = visitor.page
    assert out_of_sight(page) == []
    assert page.locator("#kicks-title").inner_text() == "Kick: anna"
    assert "Kicks go here" in card(visitor, "anna").inner_text()
    assert "Kick this one" in card(visitor, "bert").inner_text()
    card(visitor, "bert").locator(".plane").click()
    visitor.reads("#kicks-title", "Kick: bert")
    visitor.reads("#parameters-title", "Parameters: bert")
    page.click("#kick-membrane")
    visitor.until("s.robots[1].kicks.length === 1")
    bert.step(2.5)
    visitor.until("s.robots[1].kicks[0].outcome")
    assert visitor.state()["robots"][0]["kicks"] == []
    visitor.reads(".card.here", "Last: Membrane kick, 1 tick. Both reversed.")
    card(visitor, "anna").locator(".stop").click()
    visitor.until(f"{STATES} === 'stopped,running'")
    visitor.reads("#stop-words", "anna: Stopped.")
    visitor.reads(".card:not(.here)", "Stopped. The robot confirms it.")
    assert visitor.state()["selected"] == 1
    page.click("#stop")
    visitor.until(f"{STATES} === 'stopped,stopped'")
    assert page.locator(".card .state").all_inner_texts() == ["Stopped", "Stopped"]
    bert._link.loop.fail("the left motor does not answer")
    bert.step(0.3)
    visitor.until(f"{STATES} === 'stopped,fault'")
    visitor.reads(".card.here", "he left motor does not answer")


def test_without_a_link_a_stop_of_one_waits_and_stops_no_other(show, pair):
    keep = """
        window.sockets = [];
        window.WebSocket = class extends WebSocket {
            constructor(url) {
                super(url);
                sockets.push(this);
            }
        };
    """
    # Between the loss and the next attempt to connect.
    press = """
        (button) => new Promise((done) => {
            sockets.at(-1).close();
            const press = () => {
                if (lab.state().link.up) return setTimeout(press, 1);
                done(button.dispatchEvent(new PointerEvent("pointerdown", { bubbles: true })));
            };
            press();
        })
    """
    visitor = show(*pair, script=keep)
    card(visitor, "bert").locator(".stop").evaluate(press)
    visitor.until(f"s.link.up && {STATES} === 'running,stopped' && s.stop.bert === 'confirmed'")
    assert "anna" not in visitor.state()["stop"]


def test_one_kick_goes_to_all_robots_and_who_refuses_is_named(show, pair):
    anna, bert = pair
    third = robot(3, "carl")
    visitor = show(*pair, third)
    page = visitor.page
    third.stop()
    visitor.until(f"{STATES} === 'running,running,stopped'")
    for station in (*pair, third):
        station.forecasts = Forecast({"reverses": 1, "continues": 0, "stops": 0}, 1)
    page.check("#kick-all")
    visitor.reads("#kicks-title", "Kick: all robots")
    page.check("#guess-0", force=True)
    page.click("#kick-phase")
    visitor.until("s.robots[0].kicks.length && s.robots[1].kicks.length && s.note")
    assert anna.forecasts.asked == bert.forecasts.asked == ["phase"]  # not before the kick
    assert visitor.state()["note"]["message"].startswith("carl: ")
    for station in pair:
        station.step(2.5)
    visitor.until("s.score.guesses === 2 && s.robots[2].kicks.length === 0")
    page.uncheck("#kick-all")
    page.click("#kick-phase")
    visitor.until("s.robots[0].kicks.length === 2 && !s.note")
    assert len(visitor.state()["robots"][1]["kicks"]) == 1


def test_one_is_shown_large_instead_and_what_is_hidden_is_not_drawn(show, pair):
    drawn = """
        window.drawn = new Set();
        const fill = CanvasRenderingContext2D.prototype.fillRect;
        CanvasRenderingContext2D.prototype.fillRect = function (...box) {
            drawn.add(this.canvas.id || this.canvas.closest("figure")?.className);
            fill.apply(this, box);
        };
    """
    frames = """
        () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => {
            drawn.clear();
            requestAnimationFrame(() => requestAnimationFrame(() => done([...drawn])));
        })))
    """
    visitor = show(*pair, script=drawn)
    page = visitor.page
    assert set(page.evaluate(frames)) == {"left", "right", "plane"}
    page.click("#beside-switch")
    visitor.until("!s.beside.shown")
    page.click("#robots >> text=bert")
    visitor.until("r.name === 'bert'")
    assert {"left-wheel", "strips"} <= set(page.evaluate(frames))
    assert "plane" not in page.evaluate(frames)
    visitor.come_back()
    visitor.until("r && !s.beside.shown")


def test_a_robot_that_is_away_is_grey_beside_the_others(show, pair):
    anna, _ = pair
    visitor = show(*pair)
    clock = anna.clock
    anna.clock = lambda: clock() + 30
    visitor.until("s.robots[0].lost && s.beside.cards[0].stale && !s.beside.cards[1].stale")
    visitor.reads(".card.here", "Lost")
    visitor.reads(".card.here", "No word from the robot")


def test_the_keyboard_alone_chooses_kicks_and_stops(show, pair):
    visitor = show(*pair)
    page = visitor.page
    press_until(page, "Tab", "e.className === 'choose' && e.ariaLabel.endsWith('bert')")
    page.keyboard.press("Enter")
    visitor.until("r.name === 'bert'")
    press_until(page, "Tab", "e.id === 'kick-phase'")
    page.keyboard.press("Enter")
    visitor.until("r.kicks.length === 1")
    press_until(page, "Shift+Tab", "e.className === 'stop' && e.ariaLabel.endsWith('bert')")
    page.keyboard.press(" ")
    visitor.until(f"{STATES} === 'running,stopped'")
    page.keyboard.press("Escape")
    visitor.until(f"{STATES} === 'stopped,stopped'")


def test_on_a_phone_they_stand_in_a_column(show, pair):
    visitor = show(*pair, viewport={"width": 390, "height": 844}, color_scheme="dark")
    page = visitor.page
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    anna, bert = (card(visitor, name).bounding_box() for name in ("anna", "bert"))
    assert anna["y"] + anna["height"] <= bert["y"]
    assert anna["width"] > 340
    assert card(visitor, "anna").locator(".stop").bounding_box()["height"] >= 44
    assert_no_findings(page)


def test_a_twin_does_the_same_under_the_same_kick(show):
    anna = robot(3, "anna", LiveTwin())
    visitor = show(anna, viewport={"width": 1366, "height": 768})
    page = visitor.page
    assert out_of_sight(page) == []
    assert [one["twin"] for one in visitor.state()["beside"]["cards"]] == [False, True]
    twin = card(visitor, "Twin of anna")
    assert "simulated, the same kicks" in twin.inner_text()
    assert "A hand or a wall that pushes anna does not push its twin." in twin.inner_text()
    assert twin.locator("button:visible").count() == 0
    page.click("#kick-phase")
    visitor.until("r.kicks.length === 1")
    anna.step(6.5)
    visitor.until("s.twins[0].compared && s.twins[0].record.tick === r.record.tick")
    visitor.reads(".twin-card", "Last kick: both reversed. The same after 1 of 1 kick.")
    visitor.reads("#said", "Last kick: both reversed.")
    assert_no_findings(page)
    page.keyboard.press("Escape")
    anna.step(0.5)
    visitor.until("r.state === 'stopped' && s.twins[0].record.left_duty_pct === 0")
    visitor.reads(".twin-card", "Stopped")
    clock = anna.clock
    anna.clock = lambda: clock() + 30
    visitor.until("s.beside.cards.every((one) => one.stale)")
    visitor.reads(".twin-card", "Paused")
    assert_no_findings(page)


class Foreign(LiveTwin):
    """The twin of a robot with motors that nobody knows."""

    def meet(self, hello, battery_v):
        super().meet({**hello, "motor": "other"}, battery_v)


def test_why_there_is_no_twin_stands_in_its_place(show):
    visitor = show(robot(3, "anna", Foreign()), ready="s.beside.shown")
    visitor.reads(".twin-card", "does not know the motors of this robot, 'other'")
    visitor.reads(".twin-card", "--twin NAME")
