"""A guided exercise as a pupil does it: predict, try, check, read the explanation."""

import pytest

from host.lab.station import CONTINUE
from host.lab.stepped_station import SteppedStation
from tests.web.test_page import kick


class AtOnce:
    """Answers each question where it is asked."""

    def ask(self, work, question, done):
        done(work(question))


@pytest.fixture
def station(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # logs are recorded into it
    station = SteppedStation("sim://?seed=1", "anna", CONTINUE)
    yield station
    station.close()


@pytest.mark.parametrize(
    ("guess", "words"),
    [(0, "You predicted: The wheel, in both kicks. It is: The memory"), (2, "You were right")],
)
def test_an_exercise_from_the_prediction_to_the_explanation(visit, lab, station, guess, words):
    lab.session.marking.worker = AtOnce()
    visitor = visit()
    page = visitor.page
    page.click("#lessons-switch")
    page.click("text=What jumps in a kick?")
    visitor.until("r.status.state === 'stopped'")
    station.step(0.1)
    visitor.until("r.state === 'stopped'")
    page.wait_for_selector("#param-k:disabled")  # nothing moves before the prediction
    visitor.reads("#now", "It stands until you lock your prediction.")
    assert page.is_hidden(".remedy")
    assert page.is_disabled("text=What does the simulation expect?")
    assert page.is_disabled("text=Lock my prediction")
    page.click(f"#prediction-{guess}")
    page.click("text=Lock my prediction")
    visitor.reads("#lessons", "Your prediction is locked")
    visitor.until("r.status.recording")
    log = visitor.robot()["status"]["recording"]
    page.click("text=Leave the exercise")
    page.click("text=What jumps in a kick?")
    visitor.reads("#lessons", "Your prediction is locked")  # it cannot be changed by coming back
    visitor.until(f"r.status.recording && r.status.recording !== '{log}'")
    assert page.is_hidden("#prediction-0")
    page.click("text=A hint")
    visitor.reads("#lessons", "Each plane is a slice")

    page.click(".remedy")  # start
    station.step(2)
    visitor.until("r.state === 'running'")
    kick(visitor, station, "#kick-membrane")
    page.click("text=Check what I did")
    visitor.reads("#lessons .findings", "✗ a phase kick while the wheels rolled")
    page.reload()
    visitor.reads("#lessons", "Your prediction is locked")
    visitor.until("r && r.state === 'running' && r.status.recording")
    kick(visitor, station, "#kick-phase")
    page.click("text=Check what I did")
    visitor.reads("#lessons", words)
    visitor.reads("#lessons", "Things go where they were pushed last.")
    assert not visitor.robot()["status"]["recording"]
    page.click("text=Leave the exercise")
    visitor.reads("#lessons", "3 What jumps in a kick? ✓")

    page.click("text=Where am I in the plane?")
    page.click("#prediction-1")
    page.click("text=Lock my prediction")
    station.step(0.1)
    visitor.until("r.state === 'stopped'")
    visitor.reads("#now", "its motors stay off")
    assert page.is_hidden(".remedy")
    assert page.is_hidden("text=Start it to kick it.")
