"""A replay: a log in the place of a robot, from a server or from one file on a disk."""

import json

import pytest

from host.lab.one_file import one_file
from host.lab.replays import Replays
from host.lab.server import Lab
from host.lab.tape import make_tape
from host.logs.log import Log
from robot.record import NAMES
from tests.fakes import eventful
from tests.lab.tapes import twins_rows_of
from tests.web.test_access import assert_no_findings
from tests.web.visitor import Visitor


class Reader(Visitor):
    """A browser's page with a replay."""

    def until(self, condition):
        """Wait until a condition on `s`, the page's state, is true."""
        known = "const s = window.lab?.state()"
        self.page.wait_for_function(f"() => {{ {known}; return s?.log && ({condition}); }}")

    def go(self, place):
        """Move the slider to a tick. Returns the page's state there."""
        self.page.locator("#time").fill(str(place))
        self.until(f"s.place === {place} && s.drawing.shown_s === s.time_s")
        return self.state()


@pytest.fixture(scope="module")
def log():
    return eventful().log()


@pytest.fixture(scope="module")
def tape(log):
    return make_tape(log, "eventful </script>.mcap")


@pytest.fixture
def read(browser):
    """A function that opens a replay from a page's address, and waits until it is drawn."""
    readers = []

    def read(url, **context):
        reader = Reader(browser, url, **context)
        readers.append(reader)
        reader.until("s.drawing.frames > 0")
        return reader

    yield read
    complaints = [words for reader in readers for words in reader.complaints]
    for reader in readers:
        reader.context.close()
    assert complaints == []


@pytest.fixture
def read_file(read, tmp_path):
    """A function that opens a tape as a file from disk."""

    def read_file(tape, **context):
        path = tmp_path / "replay.html"
        path.write_text(one_file(tape), encoding="utf-8")
        return read(path.as_uri(), **context)

    return read_file


MINUS = "\N{MINUS SIGN}"


def typeset(text):
    """A text with its hyphens as the page writes minus signs."""
    return text.replace("-", MINUS)


def results(state):
    """The results in the working of both wheels: numbers by their symbols, the last of each."""
    found = {}
    for formula, *cells in state["working"]["lines"]:
        numbers = [cell.rpartition(" = ")[2].split()[0] for cell in cells if cell]
        found[formula.partition(" ")[0]] = [float(one.replace(MINUS, "-")) for one in numbers]
    return found


def place_of(log, tick_of):
    """The place of the first record with a kick of this kind, numbered as in its channel."""
    return next(place for place, record in enumerate(log.records) if record.kick == tick_of)


def test_a_file_from_disk_shows_each_tick_with_its_equations(read_file, log, tape):
    reader = read_file(tape)
    page = reader.page
    page.click("#digits")
    place = place_of(log, 3) + 1
    state = reader.go(place)
    record = log.records[place]
    assert [state["record"][name] for name in NAMES if "late" not in name] == [
        getattr(record, name) for name in NAMES if "late" not in name
    ]
    assert state["working"]["said"] == (
        "The robot's program computes the same bits from the logged angles."
    )
    for symbol, name in (("x₁", "x1"), ("x₂", "x2"), ("Ftan", "force"), ("M", "torque")):
        logged = [getattr(record, f"{side}_{name}") for side in ("left", "right")]
        assert results(state)[symbol] == logged, symbol
    assert typeset("(1 - 2 · 0) · cos(") in state["working"]["lines"][2][1]
    assert state["working"]["lines"][2][2] == ""  # the right wheel is not kicked
    shown = page.locator("#working tbody").inner_text()
    assert typeset(repr(record.left_torque)) in shown
    wheel = state["drawing"]["wheels"]["left"]
    assert (wheel["torque"], wheel["kick"]) == (record.left_torque, "Phase")
    membrane = place_of(log, 1)
    jumps = reader.go(membrane)["working"]["lines"]
    before = log.records[membrane - 1].left_x1
    assert any(typeset(f"from {before} to") in cells[0] for _, *cells in jumps)
    assert page.query_selector("#stop, #kicks, .kick, #hand-note") is None
    assert page.locator("#twin-left").is_hidden()


def test_keys_move_the_cursor_and_space_plays(read_file, tape):
    reader = read_file(tape)
    press = reader.page.keyboard.press
    press("ArrowRight")
    press("ArrowRight")
    press("ArrowLeft")
    reader.until("s.place === 1")
    press("Shift+ArrowRight")
    reader.until("s.place > 20 && s.place < 40")
    press("End")
    reader.until(f"s.place === {tape['ticks'] - 1}")
    press(",")
    marks = [mark["place"] for mark in reader.state()["marks"]]
    reader.until(f"s.place === {max(place for place in marks if place < tape['ticks'] - 1)}")
    press("Home")
    press(".")
    reader.until(f"s.place === {min(place for place in marks if place)}")
    press("Home")
    press(" ")
    reader.until("s.playing && s.place > 3")
    press(" ")
    reader.until("!s.playing && s.drawing.shown_s === s.record.t_s")
    press("End")
    press(" ")  # from the end it plays from the beginning
    reader.until("s.playing && s.place > 0 && s.place < 300")
    reader.page.click("#speed-1-4")
    reader.until(f"!s.playing && s.place === {tape['ticks'] - 1}")


def test_everything_that_happened_is_marked_and_a_click_goes_there(read_file, log, tape):
    reader = read_file(tape)
    marks = reader.state()["marks"]
    named = [event for event in log.events if event["event"] != "snapshot"]
    assert len(marks) == len(named) + sum(record.missed > 0 for record in log.records)
    kicks = [mark for mark in marks if mark["kind"] == "kick"]
    begins = [event["kick"]["begin"] for event in log.events if event["event"] == "kick"]
    assert [log.records[mark["place"]].tick for mark in kicks] == begins
    fault = next(mark for mark in marks if mark["kind"] == "fault")
    reader.page.click("#happened [data-kind=fault]")
    reader.until(f"s.place === {fault['place']} && s.state === 'fault'")
    reader.reads("#working", "The motors are off in this tick")
    reader.reads("#about", "recomputed, bit for bit as logged")


def test_a_log_that_is_not_computed_says_so(read_file, log):
    other = Log({**log.info, "robot_machine": "armv5tejl CPython 3.5.3"})
    records = [*log.records]
    for place, difference in ((77, 1e-9), (80, 1e-13)):
        x1 = records[place].left_x1 + difference
        records[place] = records[place]._replace(left_x1=x1)
    other.records, other.events, other.places = records, log.events, log.places
    reader = read_file(make_tape(other, "forged"))
    reader.reads("#about", "does NOT match")
    reader.page.click("#happened [data-kind=differs]")
    reader.until("s.place === 77")
    reader.reads("#working", "computes something else than the log says")
    reader.reads("#working td.differs", typeset(f"✗ logged: {records[77].left_x1}"))
    reader.go(80)
    reader.reads("#working", "As logged but for rounding")
    marks = reader.page.locator("#working td small").all_inner_texts()
    assert "".join(marks).split() == ["≈", *["✓"] * 9]


def test_everybody_can_read_it(read_file):
    tape = make_tape(eventful().log(60), "without its beginning")
    reader = read_file(tape, viewport={"width": 320, "height": 800})
    reader.reads("#working", "Not compared")
    symbols = [formula.partition(" ")[0] for formula, *_ in reader.state()["working"]["lines"]]
    assert (symbols.count("x₁"), symbols.count("dx₁/dt")) == (1, 0)
    reader.reads("#working", "from the log: 0.4952")
    reader.go(77)
    assert reader.page.evaluate("document.documentElement.scrollWidth") <= 320
    height = "(name) => document.querySelector(name).offsetHeight"
    assert reader.page.evaluate(height, ".player") < 180
    reader.page.emulate_media(color_scheme="dark")
    assert_no_findings(reader.page)
    reader.page.emulate_media(color_scheme="light")
    reader.page.set_viewport_size({"width": 1280, "height": 720})
    assert_no_findings(reader.page)
    strips = reader.page.evaluate(height, "#strips")
    reader.page.click("#digits")
    assert reader.page.evaluate(height, "#strips") == strips
    reader.page.click("#projector")
    reader.page.mouse.move(900, 400)
    reader.page.mouse.wheel(0, 400)
    reader.page.wait_for_function("() => scrollY === 400")
    at = reader.page.locator("#left-wheel").bounding_box()["y"]
    assert 0 < at < 150  # in view beside the later equations


def test_a_twin_stands_beside_the_robot(read_file, log):
    tape = make_tape(log, "log", motor="pybricks")
    reader = read_file(tape)
    reader.go(300)
    wheels = reader.state()["drawing"]["wheels"]
    twin = reader.state()["twin"]
    assert twin["kicks"] == tape["twin"]["kicks"]
    row = twins_rows_of(tape)[300]
    assert (row["left_x1"], row["right_torque"]) == (
        twin["wheels"]["left"]["x1"],
        twin["wheels"]["right"]["torque"],
    )
    assert twin["wheels"]["left"]["phi_rad"] != wheels["left"]["phi_rad"]
    assert reader.page.locator("#twin-left").is_visible()
    reader.reads("#about", "No kick was left alone for a second")


def test_a_damaged_log_is_named_as_it_is_and_so_is_the_command(read_file, tape):
    damage = "logs/a.mcap: breaks off or is damaged after tick 50; 9 of 60 ticks are missing"
    reader = read_file(tape | {"verdict": tape["verdict"] | {"damage": damage}})
    reader.reads("#about", f"Not all of this log can be read: {damage}. ")
    reader.reads("#about", "kickctl log recover LOG")


def test_a_file_that_asked_elsewhere_would_complain(read_file, tape):
    reader = read_file(tape)
    reader.page.evaluate("fetch('http://127.0.0.1:9/').catch(() => null)")
    assert "Content Security Policy" in " ".join(reader.complaints)
    reader.complaints.clear()


def test_a_lab_without_robots_serves_a_replay(browser, read, tape):
    replays = Replays()
    replays.give(tape)
    with Lab([], port=0, replays=replays) as lab:
        url = lab.view_url.replace("/#", "/replay.html?log=eventful%20%3C/script%3E.mcap#")
        reader = read(url)
        assert reader.state()["log"] == tape["name"]
        stranger = Visitor(browser, url.partition("#")[0])
        stranger.reads("#loading", "Logs need the lab's key: open the whole address")
        stranger.context.close()


def test_a_log_just_recorded_opens_in_a_replay(browser, station):
    station.step(1)
    with Lab([station], port=0, replays=Replays()) as lab:
        visitor = Visitor(browser, lab.drive_url)
        visitor.page.click(".record")
        visitor.until("r.status.recording")
        station.step(2)
        visitor.page.click(".record")
        visitor.until("!r.status.recording")
        with visitor.page.expect_popup() as popup:
            visitor.page.click(".logs a")
        popup.value.wait_for_function("() => window.lab?.state().log")
        state = popup.value.evaluate("lab.state()")
        visitor.context.close()
    assert json.dumps(state["verdict"]["exact"]) == "true"
    assert state["ticks"] >= 66
    assert visitor.complaints == []
