"""Who drives: several pages in one lab, and a driver who is not there any more."""

import pytest
from playwright.sync_api import Error

from host.lab.station import STOP
from host.lab.stepped_station import SteppedStation
from tests.web.visitor import DRAWN, Visitor


@pytest.fixture
def station():
    """A robot that stops when nobody attends to it."""
    station = SteppedStation("sim://?seed=1", "anna", STOP)
    yield station
    station.close()


def take_baton(visitor):
    visitor.page.fill("#param-k", "7")
    visitor.page.keyboard.press("Enter")
    visitor.until("s.baton.you")


def test_a_page_that_watches_says_why_and_gets_the_baton_when_it_asks(visit, lab):
    driver, pupil = visit(), visit(lab.view_url)
    take_baton(driver)
    pupil.until("s.baton.driver !== null && !s.baton.you")
    pupil.reads("#who-drives", "drives. This page watches.")
    said = pupil.page.locator("#baton > p").first.inner_text()
    assert said == f"Page {driver.state()['page']} drives. This page watches."
    assert pupil.page.is_disabled("#kick-phase")
    assert pupil.page.is_disabled("#param-k")
    pupil.page.click("#notices >> text=Ask to drive")
    pupil.reads("#who-drives", "You have asked")
    page = pupil.state()["page"]
    driver.page.click(f"text=Let page {page} drive")
    pupil.until("s.baton.you")
    pupil.page.wait_for_selector("#kick-phase:enabled")
    driver.page.wait_for_selector("#kick-phase:disabled")
    driver.until("s.note && s.note.message.includes('given')")
    driver.page.click("#notices >> text=Drive from here")
    pupil.until("!s.baton.you && s.note")
    driver.page.close()
    pupil.until("s.baton.driver === null && s.note === null")  # what it said is over


def test_a_page_that_asks_while_nobody_drives_is_seen_and_gets_the_baton(visit, lab):
    pupil, teacher = visit(lab.view_url), visit()
    assert teacher.state()["baton"]["driver"] is None
    pupil.page.click("#notices >> text=Ask to drive")
    pupil.reads("#who-drives", "Nobody drives. This page watches. You have asked to drive")
    page = pupil.state()["page"]
    teacher.reads("#baton", f"Page {page} asks to drive.")
    teacher.page.reload()  # as a teacher does who has just seen it
    teacher.page.click(f"text=Let page {page} drive")
    pupil.until("s.baton.you")
    pupil.page.wait_for_selector("#kick-phase:enabled")
    teacher.reads("#who-drives", f"Page {page} drives.")
    assert teacher.page.is_hidden(f"text=Let page {page} drive")


def test_a_driver_may_leave(visit):
    driver = visit()
    take_baton(driver)
    driver.page.click("text=Drive no more")
    driver.until("s.baton.driver === null && r.state === 'stopped'")
    driver.page.wait_for_selector(".remedy:enabled")  # the first command takes it again


@pytest.mark.parametrize("way", ["closed", "crashed"])
def test_the_robot_stops_if_its_drivers_page_is_gone(browser, visit, lab, station, way):
    driver, other = Visitor(browser, lab.drive_url), visit(lab.view_url)
    driver.until(DRAWN)
    take_baton(driver)
    other.until("s.baton.driver !== null && r.state === 'running'")
    if way == "closed":
        driver.page.close()
    else:
        with pytest.raises(Error):
            driver.page.goto("chrome://crash", timeout=2000)
    other.until("s.baton.driver === null && r.state === 'stopped'")
    other.reads("#baton", "silent")
    assert driver.complaints == []
    driver.context.close()
