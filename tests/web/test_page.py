"""The lab's page in a real Chromium, on a real server, with a robot that the test steps."""

from math import pi

import pytest

from host.errors import LeaseLost
from tests.web.test_basins import Halves


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
    assert "sign of the paper" in visitor.page.get_attribute(".mark-force", "title")
    before = visitor.robot()["record"]
    station.step(0.3)
    visitor.until(f"r.record.tick >= {before['tick'] + 10}")
    after = visitor.robot()["record"]
    assert abs(after["left_phi_rad"] - before["left_phi_rad"]) > 1
    assert visitor.state()["drawing"]["shown_s"] <= after["t_s"]


def test_a_page_that_asked_elsewhere_would_complain(visit):
    visitor = visit()
    visitor.page.evaluate("fetch('http://127.0.0.1:9/').catch(() => null)")
    assert "Content Security Policy" in " ".join(visitor.complaints)
    visitor.complaints.clear()


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
    visitor.page.fill("#param-k", "")
    visitor.page.type("#param-k", "3,5")  # as on a keyboard in German
    visitor.page.keyboard.press("Enter")
    visitor.until("r.status.params.k === 3.5")
    least = "Number(document.querySelector('#param-tau_s').min)"
    visitor.until(f"{least} === 0.09")
    visitor.page.click("#parameters summary")
    visitor.page.fill("#param-tick_s", "0.02")
    visitor.page.keyboard.press("Enter")
    visitor.until(f"{least} === 0.06")
    slider = visitor.page.locator(".param:has(#param-tau_s) [type=range]")
    slider.fill("0")  # all the way to the left
    visitor.until("r.status.params.tau_s === 0.06")
    assert visitor.state()["note"] is None
    slider.fill("200")
    visitor.until("r.status.params.tau_s === 10")
    assert visitor.page.is_disabled("#param-polarity_left-1")  # as long as the robot runs
    visitor.page.fill("#param-tau_s", "0.05")
    visitor.page.keyboard.press("Enter")
    visitor.until("s.note && s.note.message.includes('tau_s')")
    visitor.page.wait_for_function("() => document.querySelector('#param-tau_s').value === '10'")
    assert visitor.robot()["status"]["params"]["k"] == 3.5
    visitor.page.fill("#param-k", "4")
    visitor.page.keyboard.press("Enter")
    visitor.until("!s.note")  # what was refused before is over


def test_a_kick_of_half_a_tick_is_not_sent(visit, station):
    visitor = visit()
    visitor.page.click(".own summary")
    for ticks in ("2.5", "20000", "-1"):
        visitor.page.fill("#kick-ticks", ticks)
        visitor.page.click(".kick.own")
        assert "1 to 10000" in visitor.page.text_content(".own-form")
    visitor.page.fill("#kick-ticks", "4")
    kick(visitor, station, ".kick.own")
    assert [one["ticks"] for one in visitor.robot()["kicks"]] == [4]


def test_a_kick_that_a_stop_cuts_off_has_no_outcome(visit, station):
    visitor = visit()
    visitor.page.check("#guess-0", force=True)
    visitor.page.click("#kick-phase")
    visitor.until("r.kicks.length === 1")
    station.step(0.06)
    visitor.page.keyboard.press("Escape")
    visitor.until("Object.values(s.stop)[0]")
    station.step(0.3)
    visitor.reads(".verdict", "No outcome: the robot was stopped before its wheels had settled.")
    assert visitor.state()["score"]["guesses"] == 0


def test_a_kick_of_wheels_at_rest_has_words_of_its_own(visit, station):
    visitor = visit()
    visitor.page.get_by_role("button", name="k = 0.3").click()
    visitor.until("r.status.params.k === 0.3")
    station.step(4)
    visitor.page.check("#guess-2", force=True)
    kick(visitor, station, "#kick-membrane")
    visitor.reads(".verdict", "Left stayed at rest.")
    visitor.reads(".verdict", "Guess: stop. Correct.")


def test_a_page_takes_over_from_another_host(visit, station, other_program):
    visitor = visit()
    visitor.until("r.status.controller === 'bert' && !r.status.here")
    visitor.page.get_by_role("button", name="Take over from bert").click()
    visitor.until("r.status.here")
    station.step(0.3)
    visitor.until("r.status.controller !== 'bert'")
    visitor.page.get_by_role("button", name="Take over").wait_for(state="hidden")
    with pytest.raises(LeaseLost):
        other_program.start()


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


def test_a_reload_in_the_middle_is_still_the_same_page(visit, station):
    visitor = visit()
    visitor.page.click("#kick-phase")
    visitor.until("s.baton.you && r.kicks.length === 1")
    page = visitor.state()["page"]
    visitor.page.reload()
    visitor.until("r && r.records > 0")
    assert visitor.state()["page"] == page


def test_a_browser_that_keeps_nothing_opens_it_too(visit):
    visitor = visit()
    page = visitor.context.new_page()
    page.add_init_script(
        "for (const name of ['localStorage', 'sessionStorage'])"
        " Object.defineProperty(window, name, { get() { throw new Error('no storage') } });"
    )
    page.goto(visitor.page.url)
    page.wait_for_function("() => lab.state().role === 'drive'")
    page.click("#projector")
    page.wait_for_selector("#projector[aria-pressed=true]")


def test_a_copied_address_opens_a_second_page(visit):
    first = visit()
    second = visit(first.page.url)
    assert second.state()["role"] == "drive"
    assert second.state()["page"] != first.state()["page"]


def test_a_wrong_key_is_refused_in_words(browser, lab, visit):
    visitor = visit()
    page = visitor.context.new_page()
    page.goto(lab.drive_url.partition("=")[0] + "=wrong")
    page.wait_for_selector("text=the key in this address does not fit")
    assert page.is_visible("text=Try again")


def test_another_address_of_the_lab_typed_into_the_same_tab_is_tried_at_once(lab, visit):
    visitor = visit()
    page = visitor.context.new_page()
    page.goto(lab.drive_url.partition("=")[0] + "=wrong")
    page.wait_for_selector("text=Try again")
    page.goto(lab.view_url)
    page.wait_for_function("() => lab.state().link.up && lab.state().role === 'view'")
    page.goto(lab.drive_url)
    page.wait_for_function("() => lab.state().link.up && lab.state().role === 'drive'")
    page.wait_for_selector("text=Try again", state="hidden")


def test_a_page_that_is_in_is_not_disturbed_by_links_within_it(lab, visit):
    visitor = visit()
    sockets = []
    visitor.page.on("websocket", lambda socket: sockets.append(socket.url))
    visitor.page.goto(lab.drive_url.partition("#")[0] + "#kicks")
    visitor.page.go_back()
    visitor.page.wait_for_url(lab.drive_url)
    page = visitor.state()["page"]
    assert visitor.state()["link"]["up"]
    visitor.page.goto(lab.view_url)  # by now both changes have been heard
    visitor.until("s.link.up && s.role === 'view'")
    assert visitor.state()["page"] != page
    assert len(sockets) == 1


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
    station.basins = Halves()
    visitor = visit()
    visitor.until("r.basins")
    assert visitor.page.locator("#said").inner_text() == ""  # no link was lost
    lab.__exit__(None, None, None)
    visitor.until("!s.link.up")
    visitor.reads("#said", "The link to the lab is lost.")
    visitor.reads("#alarm", "What you see is old")
    assert visitor.robot()["basins"]  # they stay, too
    begin_again()
    visitor.until("s.link.up && r && r.records > 0")
    visitor.reads("#said", "The link to the lab is back.")
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


def test_a_guess_stands_beside_prediction_and_outcome(visit, lab, station):
    station.forecasts = Forecast({"reverses": 31, "continues": 1, "stops": 0}, 32)
    visitor = visit()
    visitor.page.check("#guess-0", force=True)
    kick(visitor, station, "#kick-phase")
    visitor.reads(".verdict", "Left reversed, as 31 of 32 predicted.")
    visitor.reads(".verdict", "Guess: reverse. Correct.")
    visitor.reads(".verdict", "Correct so far: you 1 of 1. The simulation 1 of 1.")
    visitor.reads("#said", "Left wheel reversed, right wheel reversed.")
    later = visit(lab.view_url)
    later.reads(".verdict", "Left reversed, as 31 of 32 predicted.")
    later.reads(".verdict", "Guess: reverse. Correct.")


def test_after_a_guess_the_kicks_say_what_the_simulation_expects(visit, lab, station):
    station.forecasts = Forecast({"reverses": 31, "continues": 1, "stops": 0}, 32)
    visitor = visit()
    visitor.reads("#kick-phase", "4 ticks")
    assert station.forecasts.asked == []  # a person guesses first
    visitor.page.check("#guess-0", force=True)
    for mode in ("membrane", "position", "phase"):
        visitor.reads(f"#kick-{mode}", "31/32 reverse")
    assert station.forecasts.asked == ["membrane", "position", "phase"]
    station.forecasts.said["shares"]["right"] = {"reverses": 2, "continues": 30, "stops": 0}
    visitor.page.fill("#param-k", "3.5")  # on another robot, they would do something else
    visitor.page.keyboard.press("Enter")
    visitor.reads("#kick-phase", "they differ")
    visitor.page.check("#wheel-2", force=True)
    visitor.reads("#kick-phase", "30/32 continue")
    kick(visitor, station, "#kick-phase")
    visitor.reads("#kick-phase", "4 ticks")


def test_the_simulation_is_asked_before_a_kick(visit, lab, station):
    station.forecasts = Forecast({"reverses": 2, "continues": 30, "stops": 0}, 32)
    visitor = visit(lab.view_url)
    visitor.page.click(".own summary")
    visitor.page.click("text=What does the simulation expect?")
    visitor.reads(".verdict", "Right: 30 of 32 will continue.")
    assert visitor.robot()["kicks"] == []


class Forecast:
    """Says the same of every kick."""

    def __init__(self, shares, of):
        self.said = {"shares": {"left": shares, "right": shares}, "of": of}
        self.asked = []

    def ask(self, question, done):
        self.asked.append(question.kick["mode"])
        done(self.said)


def test_a_wheel_is_pulled_by_the_pointer_and_by_a_key(visit, station):
    pulls = []
    station.hand_possible = True
    station.hand = lambda wheel, angle_rad: pulls.append((wheel, angle_rad))
    visitor = visit()
    canvas = visitor.page.locator("#left-wheel")
    canvas.wait_for()
    box = canvas.bounding_box()
    axle = visitor.page.evaluate(
        """async () => {
            const { layout } = await import("/draw/wheel.js");
            return layout(document.querySelector("#left-wheel"), { scale: devicePixelRatio });
        }"""
    )
    x, y = box["x"] + axle["x"], box["y"] + axle["y"]
    visitor.page.evaluate("scrollTo(0, 0)")
    for beside in (1.3, 0.8):
        assert pulls == []
        visitor.page.mouse.move(x + beside * axle["radius"], y)
        visitor.page.mouse.up()
        visitor.page.mouse.down()
    visitor.page.mouse.move(x, y - 0.8 * axle["radius"], steps=5)
    wait_for(visitor, lambda: len(pulls) > 1 and pulls[-1][1] - pulls[0][1] > 1.4)
    visitor.page.mouse.up()
    wait_for(visitor, lambda: pulls[-1] == ("left", None))
    assert pulls[-2][1] - pulls[0][1] == pytest.approx(pi / 2, abs=0.1)
    visitor.page.focus("#right-wheel")
    visitor.page.keyboard.down("ArrowUp")
    wait_for(visitor, lambda: pulls[-1][0] == "right" and pulls[-1][1] is not None)
    visitor.page.keyboard.up("ArrowUp")
    wait_for(visitor, lambda: pulls[-1] == ("right", None))


def wait_for(visitor, condition):
    """Let the page go on until a condition on this side holds."""
    while not condition():
        visitor.page.evaluate("new Promise(requestAnimationFrame)")
