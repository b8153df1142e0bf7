"""The guided exercises as a pupil does them: predict, try, check, read the explanation.

Each one twice, first with a wrong prediction and then with the right one. The robot's time passes
only when the pupil waits.
"""

import re
from threading import Thread

import pytest

from host.lab.lessons.texts import lessons
from host.lab.station import CONTINUE
from host.lab.stepped_station import SteppedStation
from sim_motor.hand import pull
from tests.lab.pupils import WALLS
from tests.web.test_access import assert_no_findings
from tests.web.test_page import wait_for

LESSONS = {lesson["name"]: lesson for lesson in lessons()}
TICK_S = 0.03


class Beside:
    """Answers each question in a thread: the server does not wait, or pages take it for dead."""

    def ask(self, work, question, done):
        Thread(target=lambda: done(work(question))).start()


class WalledStation(SteppedStation):
    """A robot that says to pages that it has walls."""

    def description(self):
        return super().description() | {"walls": 2.0}


class HandyStation(SteppedStation):
    """A robot whose wheels can be pulled."""

    hand_possible = True

    def __init__(self, *args):
        self.pulled = {}
        super().__init__(*args)

    def hand(self, wheel, angle_rad):
        self.pulled[wheel] = angle_rad

    def step_by_hand(self, seconds):
        """Let time pass while the left wheel is pulled."""
        brick = self._link.brick
        motor = brick.motors[0]
        for _ in range(round(seconds / TICK_S)):
            truth = motor.truth()
            away_rad = motor.mount * self.pulled["left"] - truth.wheel_angle
            brick.set_load(0, pull(away_rad, truth.wheel_speed))
            self.step(TICK_S)
        brick.set_load(0, 0.0)


@pytest.fixture
def station(tmp_path, monkeypatch, request):
    monkeypatch.chdir(tmp_path)  # logs are recorded into it
    if "wall" in request.node.name:
        station = WalledStation(f"{WALLS}&seed=1&idle=1", "anna", CONTINUE)
    else:
        station = HandyStation("sim://?seed=1", "anna", CONTINUE)
    yield station
    station.close()


@pytest.fixture
def pupil(visit, lab, station):
    lab.session.marking.worker = Beside()
    pupil = visit()
    pupil.page.click("#lessons-switch")
    return pupil


def begin(pupil, station, name, guess):
    """Choose an exercise, and lock a prediction."""
    page, lesson = pupil.page, LESSONS[name]
    page.click(f"#lessons >> text={lesson['title']}")
    wait_for(pupil, lambda: station.state()["state"] in ("stopped", "idle"))
    station.step(TICK_S)
    page.click(f"#prediction-{guess}")
    page.click("text=Lock my prediction")
    pupil.reads("#lessons", f"Your prediction is locked: {lesson['answers'][guess]}")
    if "model" not in lesson:
        pupil.until("r.status.recording")


def start(pupil, station, seconds=2.0):
    pupil.page.click(".remedy")
    wait_for(pupil, lambda: station.state()["state"] == "running")
    station.step(seconds)
    pupil.until("r.state === 'running'")


def stop(pupil, station):
    pupil.page.keyboard.press("Escape")
    wait_for(pupil, lambda: station.state()["state"] == "stopped")
    station.step(TICK_S)
    pupil.page.wait_for_selector(".remedy:visible")


def kick(pupil, station, button, seconds=2.5):
    known = pupil.robot()["kicks"]
    last = known[-1]["id"] if known else ""
    pupil.page.click(button)
    pupil.until(f"r.kicks.length && r.kicks.at(-1).id !== '{last}'")
    station.step(seconds)


def ten_starts(pupil, station):
    for _ in range(10):
        start(pupil, station, 1.1)
        stop(pupil, station)


def turn_by_hand(pupil, station):
    page = pupil.page
    assert page.is_hidden(".remedy")
    assert page.is_hidden("text=Start it to kick it.")
    page.focus("#left-wheel")
    for key in ("ArrowUp", "ArrowDown"):
        page.keyboard.down(key)
        wait_for(pupil, lambda: station.pulled.get("left") is not None)
        station.step_by_hand(1.0)
        page.keyboard.up(key)
        wait_for(pupil, lambda: station.pulled["left"] is None)


def two_kicks(pupil, station):
    start(pupil, station)
    kick(pupil, station, "#kick-membrane")
    kick(pupil, station, "#kick-phase")


def kicks_of_many_lengths(pupil, station):
    page = pupil.page
    start(pupil, station)
    if page.is_hidden("#kick-ticks"):
        page.click(".own summary")
    for ticks in (1, 2, 3, 3, 4, 4, 6, 6, 10, 10):
        page.fill("#kick-ticks", str(ticks))
        kick(pupil, station, ".own-form .kick", 3.0)


def lower_and_raise_k(pupil, station):
    start(pupil, station)
    for k in (0.7, 0.5, 0.35, 0.5, 0.6, 0.9, 1.4, 2.5):
        pupil.page.fill("#param-k", str(k))
        pupil.page.press("#param-k", "Enter")
        pupil.until(f"r.status.params.k === {k}")
        station.step(2.0)


def wait_at_the_walls(pupil, station):
    start(pupil, station, 16.0)


def find_k(pupil, station):
    """Let the model wheel ring at some k, and take the middle of dying and growing."""
    page = pupil.page
    sizes = {}
    for k in (1.5, 1.4, 1.55, 1.6, 1.65):
        page.fill("#model-value", str(k))
        page.click("text=Turn it by 0.1 rad")
        pupil.reads("#lessons", f"k = {k:.2f}: it rings")
        assert float(page.input_value("#model-value")) == k
        line = page.inner_text(f"#lessons li:has-text('k = {k:.2f}')")
        sizes[k] = int(re.search(r"have (\d+) %", line)[1])
    dying = max(k for k, size in sizes.items() if size < 100)
    growing = min(k for k, size in sizes.items() if size > 100)
    page.fill("#own-number", f"{(dying + growing) / 2:.3f}")


def find_slope(pupil, station):
    """Let twins go, and take the slope of the mean."""
    page = pupil.page
    for number in range(1, 9):
        page.click("text=Let a pair of twins go")
        pupil.reads("#lessons", f"pair {number}: ln d")
    line = page.inner_text("#lessons .bench [role=status]").replace("\N{MINUS SIGN}", "-")
    early, late = map(float, re.search(r"ln d = (\S+) at 2 s, (\S+) at 12 s", line).groups())
    page.fill("#own-number", f"{(late - early) / 10:.2f}")


DO = {
    "start": ten_starts,
    "trace": turn_by_hand,
    "jump": two_kicks,
    "longer": kicks_of_many_lengths,
    "rest": find_k,
    "there-and-back": lower_and_raise_k,
    "wall": wait_at_the_walls,
    "twins": find_slope,
}


def test_the_model_wheel_is_for_everybody_for_a_laptop_and_for_a_phone(pupil, station):
    page = pupil.page
    begin(pupil, station, "twins", 0)
    for number in (1, 2):
        page.click("text=Let a pair of twins go")
        pupil.reads("#lessons", f"pair {number}: ln d")
    assert_no_findings(page)
    page.set_viewport_size({"width": 1366, "height": 768})
    page.evaluate("scrollTo(0, 0)")
    for part in (".locked", ".bench canvas:last-of-type", "#own-number", "text=Check what I did"):
        box = page.locator(f"#lessons >> {part}").bounding_box()
        assert box["y"] + box["height"] <= 768, part  # without a scroll
    page.set_viewport_size({"width": 320, "height": 640})
    assert page.evaluate("document.documentElement.scrollWidth") <= 320


@pytest.mark.parametrize("name", LESSONS)
def test_who_does_an_exercise_hears_whether_the_prediction_was_right(pupil, station, name):
    page, lesson = pupil.page, LESSONS[name]
    right = lesson["right"]
    answer, other = lesson["answers"][right], lesson["answers"][0]
    for guess, words in (
        (0, f"You predicted: {other}. It is: {answer}."),
        (right, f"You were right: {answer}."),
    ):
        begin(pupil, station, name, guess)
        DO[name](pupil, station)
        page.click("text=Check what I did")
        page.wait_for_selector("#lessons .findings li")
        assert "✗" not in page.inner_text("#lessons .findings")
        pupil.reads("#lessons", words)
        pupil.reads("#lessons", lesson["misconception"])
        page.click("text=Leave the exercise")
        pupil.reads("#lessons", f"{lesson['title']} ✓")


def test_a_locked_prediction_outlasts_leaving_and_a_closed_tab(pupil, station):
    page = pupil.page
    page.click("text=What jumps in a kick?")
    pupil.until("r.status.state === 'stopped'")
    station.step(TICK_S)
    pupil.until("r.state === 'stopped'")
    page.wait_for_selector("#param-k:disabled")  # nothing moves before the prediction
    pupil.reads("#now", "It stands until you lock your prediction.")
    assert page.is_hidden(".remedy")
    assert page.is_disabled("text=What does the simulation expect?")
    assert page.is_disabled("text=Lock my prediction")
    page.click("#prediction-0")
    page.click("text=Lock my prediction")
    pupil.reads("#lessons", "Your prediction is locked")
    pupil.until("r.status.recording")
    log = pupil.robot()["status"]["recording"]
    page.click("text=Leave the exercise")
    page.click("button:has-text('What jumps in a kick?')")  # its title still shows for a moment
    pupil.reads("#lessons", "Your prediction is locked")
    pupil.until(f"r.status.recording && r.status.recording !== '{log}'")
    assert page.is_hidden("#prediction-0")
    page.click("text=A hint")
    pupil.reads("#lessons", "Each plane is a slice")
    start(pupil, station)
    kick(pupil, station, "#kick-membrane")
    page.click("text=Check what I did")
    pupil.reads("#lessons .findings", "✗ a phase kick while the wheels rolled")
    pupil.come_back()
    page = pupil.page
    pupil.reads("#lessons", "Your prediction is locked")
    pupil.until("r && r.state === 'running' && r.status.recording")
    kick(pupil, station, "#kick-phase")
    page.click("text=Check what I did")
    pupil.reads("#lessons", "Things go where they were pushed last.")
    assert not pupil.robot()["status"]["recording"]
