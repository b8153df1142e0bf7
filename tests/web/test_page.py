"""The lab's page in a real Chromium, on a real server, with a robot that the test steps."""

import pytest


def turns(visitor):
    """Which way the wheels turn, as the newest record says: 1, -1 or 0 of left and right."""
    record = visitor.robot()["record"]
    speeds = (record["left_omega_rad_s"], record["right_omega_rad_s"])
    return [(speed > 6) - (speed < -6) for speed in speeds]


def kick(visitor, station, button):
    """Press a button that kicks, and let the kick take effect."""
    known = len(visitor.robot()["kicks"])
    visitor.page.click(button)
    visitor.until(f"r.kicks.length === {known + 1}")
    tick = visitor.robot()["record"]["tick"]
    station.step(2.5)
    visitor.until(f"r.record.tick > {tick} + 70")


def test_the_wheels_turn(visit, station):
    visitor = visit()
    before = visitor.robot()["record"]
    station.step(0.3)
    visitor.until(f"r.record.tick >= {before['tick'] + 10}")
    after = visitor.robot()["record"]
    assert abs(after["left_phi_rad"] - before["left_phi_rad"]) > 1
    assert visitor.state()["drawing"]["shown_s"] <= after["t_s"]


@pytest.mark.parametrize("mode", ["membrane", "position", "phase"])
def test_each_kick_of_the_paper_reverses(visit, station, mode):
    visitor = visit()
    before = turns(visitor)
    assert 0 not in before
    kick(visitor, station, f"#kick-{mode}")
    assert turns(visitor) == [-way for way in before]
    newest = visitor.robot()["kicks"][-1]
    assert newest["mode"] == mode
    assert newest["begin_s"] < newest["end_s"]


def test_a_kick_of_ones_own_reverses_one_wheel(visit, station):
    visitor = visit()
    before = turns(visitor)
    visitor.page.click("#wheel-1")
    visitor.page.click(".own summary")
    visitor.page.click("#mode-3")  # a pulse
    visitor.page.click("#pulsed-3")  # of beta
    visitor.page.fill("#kick-ticks", "3")
    kick(visitor, station, ".kick.own")
    assert turns(visitor) == [-before[0], before[1]]
    newest = visitor.robot()["kicks"][-1]
    assert (newest["mode"], newest["ticks"], newest["wheels"]) == ("pulse", 3, ["left"])


def test_a_parameter_is_sent_and_a_wrong_one_goes_back(visit, station):
    visitor = visit()
    visitor.page.fill("#param-k", "3.5")
    visitor.page.keyboard.press("Enter")
    visitor.until("r.status.params.k === 3.5")
    visitor.page.fill("#param-tau_s", "0.05")
    visitor.page.keyboard.press("Enter")
    visitor.until("s.note && s.note.message.includes('tau_s')")
    visitor.page.wait_for_function("() => document.querySelector('#param-tau_s').value === '0.25'")
    assert visitor.robot()["status"]["params"]["k"] == 3.5


def test_a_preset_sets_what_the_paper_says(visit):
    visitor = visit()
    visitor.page.get_by_role("button", name="k = 2").click()
    visitor.until("r.status.params.k === 2")


def test_a_log_is_recorded_and_downloaded(visit, station):
    visitor = visit()
    visitor.page.click(".record")
    visitor.until("r.status.recording")
    station.step(1)
    visitor.page.click(".record")
    visitor.until("!r.status.recording")
    with visitor.page.expect_download() as download:
        visitor.page.click(".logs button")
    assert download.value.suggested_filename.endswith(".mcap")
    assert download.value.path().read_bytes().startswith(b"\x89MCAP0\r\n")


def test_a_reload_in_the_middle_keeps_page_and_baton(visit, station):
    visitor = visit()
    visitor.page.click("#kick-phase")
    visitor.until("s.baton.you && r.kicks.length === 1")
    page = visitor.state()["page"]
    visitor.page.reload()
    visitor.until("r && r.records > 0")
    assert visitor.state()["page"] == page


def test_a_copied_address_opens_a_second_page(visit):
    first = visit()
    second = visit(first.page.url)
    assert second.state()["role"] == "drive"
    assert second.state()["page"] != first.state()["page"]


def test_a_wrong_key_is_refused_in_words(browser, lab, visit):
    visitor = visit()
    page = visitor.context.new_page()
    page.goto(lab.drive_url.partition("=")[0] + "=wrong")
    page.wait_for_selector("text=key does not fit")
    assert page.is_visible("text=Try again")


def test_a_robot_that_is_away_is_grey_and_comes_back(visit, station):
    visitor = visit()
    clock = station.clock
    station.clock = lambda: clock() + 30
    visitor.until("r.lost")
    visitor.reads("#now", "No word from the robot")
    visitor.reads("#said", "anna does not answer.")
    assert visitor.robot()["records"] > 0  # the last values stay
    station.clock = clock
    station.step(0.3)
    visitor.until("!r.lost && r.state === 'running'")


def test_a_lab_that_is_gone_is_said_and_found_again(visit, lab, station, begin_again):
    visitor = visit()
    lab.__exit__(None, None, None)
    visitor.until("!s.link.up")
    visitor.reads("#notices", "What you see is old")
    begin_again()
    visitor.until("s.link.up && r && r.records > 0")
    visitor.forgive("WebSocket connection to")


def test_a_fault_has_a_button_that_clears_it(visit, station):
    visitor = visit()
    station._link.loop.fail("the left motor does not answer")
    station.step(0.3)
    visitor.until("r.state === 'fault' && r.status.remedy === 'clear'")
    visitor.reads("#now", "he left motor does not answer")
    visitor.page.click(".remedy")
    visitor.until("r.status.remedy === 'start'")
    visitor.page.click(".remedy")
    station.step(0.3)
    visitor.until("r.state === 'running'")
