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
FILLED = "r && s.beside.cards.length && s.drawing.frames > 0"
READY = f"{FILLED} && s.beside.cards.every((one) => one.traced > 50)"
# The parts of the first screen that must be seen without scrolling.
SEEN = ".card canvas, .card .stop:not([hidden]), #stop, #kick-phase"


@pytest.fixture
def show(window):
    """A function that opens a page on a lab with some robots."""
    with ExitStack() as stack:
        visitors = []

        def show(*stations, script="", ready=READY, **context):
            for station in stations:
                stack.callback(station.close)
                station.step(3.0)
            lab = stack.enter_context(Lab(stations, port=0))
            visitor = Visitor(window(len(visitors)), lab.drive_url, script, **context)
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


def test_before_a_prediction_nothing_says_to_press_the_hidden_start(show, pair):
    visitor = show(*pair)
    page = visitor.page
    page.click("#lessons-switch")
    page.click("text=What jumps in a kick?")
    visitor.until("r.status.remedy === 'start'")
    visitor.reads(".card[aria-label=anna]", "It stands until you lock your prediction.")
    visitor.reads("#state", "It stands until you lock your prediction.")
    assert card(visitor, "anna").locator(".remedy").is_hidden()
    assert page.locator("text=Start it:").count() == 0


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
    visitor.reads(".card.here", "Last: Membrane kick, 1 tick. Both wheels reversed.")
    card(visitor, "anna").locator(".stop").click()
    visitor.until(f"{STATES} === 'stopped,running'")
    visitor.reads("#stop-words", "anna: Stopped.")
    visitor.reads(".card:not(.here)", "Stopped. The robot confirms it.")
    assert visitor.state()["selected"] == 1
    page.click("#stop")
    visitor.until(f"{STATES} === 'stopped,stopped'")
    for name in ("anna", "bert"):
        visitor.reads(f".card[aria-label='{name}'] .state", "Stopped")
    bert._link.loop.fail("the left motor does not answer")
    bert.step(0.3)
    visitor.until(f"{STATES} === 'stopped,fault'")
    visitor.reads(".card.here", "he left motor does not answer")


LONG = "tcp://192.168.178.123:847"
# Where each STOP stands, and what of a card's words is cut or covered.
STOPS = """
    () => [...document.querySelectorAll(".stop:not([hidden])")]
        .map((one) => { const { x, y } = one.getBoundingClientRect(); return [x, y]; })
"""
HIDDEN = """
    () => [...document.querySelectorAll(".card .info > *")].filter((one) => {
        const box = one.getBoundingClientRect();
        const card = one.closest(".card").getBoundingClientRect();
        const note = document.querySelector(".notice.note").getBoundingClientRect();
        const over = note.height && note.top < box.bottom && note.left < box.right;
        return box.height && (box.bottom > card.bottom || box.bottom > innerHeight || over);
    }).map((one) => one.innerText)
"""


def test_no_stop_moves_and_no_word_of_a_card_is_cut(show):
    written = """
        window.written = new Set();
        const write = CanvasRenderingContext2D.prototype.fillText;
        CanvasRenderingContext2D.prototype.fillText = function (words, ...rest) {
            if (this.canvas.closest(".plane")) written.add(words);
            write.call(this, words, ...rest);
        };
    """
    stations = [robot(n, f"{LONG}{n}", LiveTwin()) for n in (2, 3)]
    visitor = show(*stations, script=written, viewport={"width": 1366, "height": 768})
    page = visitor.page
    assert {"\u22123", "0", "3"} <= set(page.evaluate("[...written]"))
    places = page.evaluate(STOPS)
    assert len(places) == 3
    stations[0].stop()
    stations[1].stop = lambda: None
    visitor.until(f"{STATES} === 'stopped,running'")
    page.click("#stop")
    visitor.reads(".card:nth-child(3)", "NOT confirmed. Look at the wheels")
    assert page.evaluate(STOPS) == places
    assert page.evaluate(HIDDEN) == []
    card(visitor, f"{LONG}2").locator(".remedy").click()
    visitor.until(f"{STATES} === 'running,running'")
    assert page.evaluate(STOPS) == places


def test_a_lost_robot_is_spoken_of_in_the_past_and_its_notice_goes_when_it_is_back(show, pair):
    anna, bert = pair
    third = robot(3, "carl")
    third.step, third._status = lambda seconds: None, {}
    ready = f"{FILLED} && s.robots[0].records > 50 && s.robots[1].records > 50"
    visitor = show(*pair, third, ready=ready)
    page = visitor.page
    visitor.reads(".card:nth-child(3)", "Not there yet\n")
    visitor.reads(".card:nth-child(3)", "The page finds it when it comes.")
    card(visitor, "bert").locator(".stop").click()
    visitor.until("s.robots[1].state === 'stopped'")
    card(visitor, "bert").locator(".choose").click()
    clock = bert.clock
    bert.clock = lambda: clock() + 30
    visitor.reads(".card.here", "It had stopped when it was last heard, 3")
    visitor.reads("#stop-words", "bert: It had stopped")
    visitor.reads("#kicks", "bert is lost: no word from it for 3")
    page.wait_for_selector("#kick-phase:disabled")
    bert._say("the stop failed: [Errno 104] reset", "look into /root/secret/bert.token")
    visitor.reads(".notice.note", "bert: The stop failed: reset. Look into bert.token.")
    assert page.evaluate(HIDDEN) == []
    page.check("#kick-all")
    visitor.reads(".resting", "bert is lost: no word from it for 3")
    page.wait_for_selector("#kick-phase:enabled")
    # What is the same for all is said once, also if one of them is lost.
    with pytest.MonkeyPatch.context() as patch:
        for station in (*pair, third):
            patch.setattr(station, "stop", lambda: None)
        page.keyboard.press("Escape")
        visitor.until("Object.values(s.stop).join() === 'unconfirmed,unconfirmed,unconfirmed'")
    visitor.reads("#stop-words", "NOT confirmed")
    assert page.locator("#stop-words").inner_text().count("NOT confirmed") == 1
    anna.stop()
    visitor.reads(".resting", "No robot runs. anna does not run. Press its Start. bert is lost")
    bert.clock = clock
    bert.step(0.1)
    visitor.until("!s.robots[1].lost && !s.note")
    bert.clock = lambda: clock() + 30
    visitor.until("s.robots[1].lost")
    bert._say("it is back, and was stopped", lasts=True)
    visitor.until("s.note")
    bert.clock = clock
    bert.step(0.1)
    visitor.until("!s.robots[1].lost")
    assert visitor.state()["note"]


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
    refusal = "so it cannot be kicked. Press its Start."
    visitor.reads(".notice.note", refusal)
    assert page.locator(".notice.note").inner_text().startswith("carl: ")
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
    visitor = show(*pair, script=drawn)
    page = visitor.page

    def drawn_as_they_move(shown_s):
        before = page.evaluate(
            f"() => {{ drawn.clear(); const s = lab.state(); return {shown_s} }}"
        )
        for station in pair:
            station.step(0.1)
        visitor.until(f"{shown_s} > {before} + 0.05")
        return set(page.evaluate("[...drawn]"))

    cards_s = "Math.min(...s.beside.cards.map(({ time }) => time))"
    assert drawn_as_they_move(cards_s) == {"left", "right", "plane"}
    page.click("#beside-switch")
    visitor.until("!s.beside.shown")
    page.click("#robots >> text=bert")
    visitor.until("r.name === 'bert'")
    large = drawn_as_they_move("s.drawing.shown_s")
    assert {"left-wheel", "strips"} <= large
    assert "plane" not in large
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
    same = "Last kick, anna and its twin: both wheels reversed."
    visitor.reads(".twin-card", f"{same} The same after 1 of 1 kick.")
    visitor.reads("#said", same)
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
    visitor = show(robot(3, "anna", Foreign()), ready=FILLED)
    visitor.reads(".twin-card", "does not know the motors of this robot, 'other'")
    visitor.reads(".twin-card", "--twin NAME")
