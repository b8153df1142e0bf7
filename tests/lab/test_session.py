"""Keys, baton, beat and stop, without sockets and in virtual time."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from host.lab.admission import MAX_PAGES
from host.lab.requests import MAX_BYTES
from host.lab.session import MAX_STRANGERS
from robot.params import TABLE
from tests.lab.conftest import QuietLab

KICK = {"robot": "anna", "command": "kick", "arguments": {"mode": "phase", "ticks": 4}}


def test_the_welcome_has_all_that_a_page_needs(lab):
    welcome = lab.driver().latest("welcome")
    assert welcome["page"] == 1
    assert welcome["role"] == "drive"
    assert welcome["unattended"] == {"anna": "stop", "bert": "continue"}
    robot = welcome["robots"][0]
    assert [row["name"] for row in robot["params"]] == list(TABLE)
    assert {"left_lag_rad", "x_m"} <= {row["name"] for row in robot["derived"]}
    assert robot["events"][-1]["event"] == "snapshot"
    json.dumps(welcome, allow_nan=False)
    assert lab.viewer().latest("welcome")["role"] == "view"


@pytest.mark.parametrize(
    ("key", "words"),
    [("", "has no key"), *((key, "does not fit") for key in ("wrong", "\ud800", "drive"))],
)
def test_a_wrong_key_lets_nobody_in(lab, key, words):
    visit = lab.stranger(key)
    assert words in visit.latest("refused")["message"]
    assert visit.page.closed
    visit.send("stop", robot=None)
    assert lab.anna.take() == []
    assert not lab.session.pages


def test_who_has_not_joined_may_do_nothing(lab):
    visit = lab.stranger()
    assert "has not joined" in visit.ask("do", **KICK)["error"]["message"]
    visit.send("stop", robot=None)
    assert lab.anna.take() == []
    lab.wait(6.0)
    assert visit.latest("refused")


def test_the_drive_key_works_on_this_computer_only(lab):
    assert "only on the computer" in lab.driver(local=False).latest("refused")["message"]
    assert lab.viewer(local=False).latest("welcome")
    assert lab.session.may_read(lab.keys.view, local=False)
    assert not lab.session.may_read(lab.keys.drive, local=False)


def test_the_first_command_takes_a_free_baton_and_no_other(lab):
    one, two = lab.driver(), lab.driver()
    one.send("do", request=1, **KICK)
    assert one.drives
    ((command, arguments),) = lab.anna.take()
    assert command == "kick"
    assert arguments.pop("id")
    assert arguments == {"mode": "phase", "ticks": 4}
    assert "page 1 drives" in two.ask("do", **KICK)["error"]["message"]
    assert lab.anna.take() == []
    lab.anna.answers[0]({"tick": 7})
    assert one.latest("reply") == {"type": "reply", "request": 1, "result": {"tick": 7}}


def test_who_may_only_watch_does_nothing_but_stop(lab):
    visit = lab.viewer()
    assert "may only watch" in visit.ask("do", **KICK)["error"]["message"]
    assert "drive key" in visit.ask("take")["error"]["message"]
    assert (
        "only the page that drives"
        in visit.ask("hand", robot="anna", wheel="left", angle_rad=1)["error"]["message"]
    )
    visit.send("stop", robot="bert")
    assert (lab.anna.take(), lab.bert.take()) == ([], [("stop",)])
    for robot in (None, "carl", 7):
        visit.send("stop", robot=robot)
        assert lab.anna.take() == lab.bert.take() == [("stop",)]


def test_a_driver_that_leaves_gives_the_robots_back_by_their_rule(lab):
    visit = lab.driver()
    visit.send("ask", request=1)
    assert visit.ask("leave")["result"] == {}
    assert [one[0] for one in lab.anna.take()] == ["abandon"]
    assert visit.latest("baton")["driver"] is None
    assert "error" in visit.ask("leave")


def test_a_silent_driver_drives_no_more_and_may_begin_again(lab):
    visit, other = lab.driver(), lab.driver()
    visit.send("do", request=1, **KICK)
    lab.anna.take()
    lab.wait(3.0, visit)
    assert visit.drives
    assert lab.anna.attended_at == lab.now
    lab.wait(0.9)
    assert visit.drives
    lab.wait(0.3)
    attended_at = lab.anna.attended_at
    assert [one[0] for one in lab.anna.take()] == ["abandon"]
    assert "silent for 1 s" in other.latest("baton")["why"]
    lab.wait(1.0)
    assert lab.anna.attended_at == attended_at
    visit.send("beat")
    assert not visit.drives
    visit.send("do", request=2, **KICK)
    assert visit.drives


def test_a_driver_that_reloads_its_page_drives_on(lab):
    visit = lab.driver()
    visit.send("ask", request=1)
    lab.wait(0.5, visit)
    visit.leave()
    lab.wait(0.5)
    again = lab.driver(resume=1)
    assert again.page.number == 1
    assert again.drives
    lab.wait(1.0, again)
    assert lab.anna.take() == []


def test_a_driver_that_does_not_come_back_drives_no_more(lab):
    visit = lab.driver()
    visit.send("ask", request=1)
    visit.leave()
    lab.wait(1.2)
    assert [one[0] for one in lab.anna.take()] == ["abandon"]


def test_nobody_takes_the_number_of_another_role_or_of_a_page_that_is_there(lab):
    visit = lab.driver()
    visit.send("ask", request=1)
    assert lab.driver(resume=1).page.number == 2
    visit.leave()
    thief = lab.viewer(resume=1)
    assert thief.page.number == 3
    assert not thief.drives


@pytest.mark.parametrize("resume", [True, -1, 1e9, "1", [1], {}])
def test_a_page_that_comes_back_from_nowhere_is_new(lab, resume):
    assert lab.driver(resume=resume).page.number == 1


def test_too_many_watchers_lock_no_driver_out(lab):
    watchers = [lab.viewer() for _ in range(MAX_PAGES)]
    refused = [visit for visit in watchers if visit.page.closed]
    assert 0 < len(refused) < 10
    assert "places for pages are taken" in refused[0].latest("refused")["message"]
    drivers = [lab.driver() for _ in range(10)]
    assert len(lab.session.pages) == MAX_PAGES
    assert not drivers[0].page.closed
    assert drivers[-1].page.closed
    watchers[0].leave()
    assert not lab.driver().page.closed


def test_connections_that_say_nothing_keep_nobody_out(lab):
    silent = [lab.stranger() for _ in range(3 * MAX_STRANGERS)]
    assert lab.driver().latest("welcome")
    assert sum(not visit.page.closed for visit in silent) < MAX_STRANGERS


def test_a_flood_is_refused_but_never_a_stop(lab):
    visit = lab.driver()
    for _ in range(600):
        visit.send("do", request=1, **KICK)
    kicks = len(lab.anna.take())
    assert 200 < kicks < 400
    assert "too much" in visit.latest("reply")["error"]["message"]
    visit.send("stop", robot=None)
    assert lab.anna.take() == [("stop",)]
    lab.wait(2.0, visit)
    visit.send("do", request=2, **KICK)
    assert lab.anna.take()


def test_a_page_that_reads_nothing_is_closed_and_takes_no_memory(lab):
    visit = lab.driver()
    for _ in range(5000):
        lab.session.broadcast({"type": "note", "message": "", "hint": ""})
    assert visit.page.closed
    assert not visit.page.waiting


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        "[]",
        "null",
        "7",
        '{"type": 7}',
        "[" * 2000,
        '{"type": "stop", "robot": NaN}',
        "9" * 4000,
        json.dumps({"type": "note", "x": "y" * MAX_BYTES}),
    ],
)
def test_what_is_no_message_is_answered_in_words(lab, text):
    visit = lab.driver()
    visit.send_text(text)
    note = visit.latest("note")
    assert note["message"]
    assert note["hint"]
    assert not visit.page.closed


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"robot": "carl", "command": "start"}, "no robot 'carl'"),
        ({"robot": "anna", "command": "fly"}, "no command 'fly'"),
        ({"robot": "anna", "command": "start", "arguments": 7}, "no object"),
        ({"robot": "anna", "command": "kick"}, None),
        ({"robot": "anna", "command": "kick", "arguments": {"id": "x"}}, "no 'id'"),
        ({"robot": "anna", "command": "kick", "arguments": {"guess": "flies"}}, "guess"),
        ({"robot": "anna", "command": "set", "arguments": {"set": {}}}, "no parameter"),
        ({"robot": "anna", "command": "set", "arguments": {"set": {"k": True}}}, "number or text"),
        ({"robot": "anna", "command": "preset", "arguments": {"name": "x"}}, "choose from rest"),
        ({"robot": "anna", "command": "primitive", "arguments": {}}, "'name' is missing"),
        ({"robot": "anna", "command": "record", "arguments": {"on": 1}}, "true nor false"),
        (
            {"robot": "anna", "command": "set", "arguments": {"set": {"link_loss": "continue"}}},
            "drive on when nobody attends",
        ),
    ],
)
def test_a_command_is_checked_before_it_reaches_a_robot(lab, fields, words):
    visit = lab.driver()
    visit.send("do", request=5, **fields)
    if words is None:
        assert lab.anna.take()
        return
    error = visit.latest("reply")["error"]
    assert words in error["message"] + error["hint"]
    assert lab.anna.take() == []
    assert not visit.drives


def test_a_robot_that_may_go_on_may_also_be_told_to(lab):
    visit = lab.driver()
    change = {"set": {"link_loss": "continue"}}
    visit.send("do", request=1, robot="bert", command="set", arguments=change)
    assert lab.bert.take() == [("set", change)]


def test_only_the_driver_pulls_a_wheel(lab):
    visit, other = lab.driver(), lab.driver()
    visit.send("ask", request=1)
    visit.send("hand", robot="anna", wheel="left", angle_rad=1.5)
    visit.send("hand", robot="anna", wheel="left", angle_rad=None)
    assert lab.anna.take() == [("hand", "left", 1.5), ("hand", "left", None)]
    for fields in (
        {"wheel": "up"},
        {"wheel": "left", "angle_rad": "x"},
        {"wheel": "left", "robot": 1},
    ):
        visit.send("hand", **{"robot": "anna", "angle_rad": 0.0, **fields})
    other.send("hand", robot="anna", wheel="left", angle_rad=1.5)
    assert lab.anna.take() == []


def test_pages_hear_how_many_they_are(lab):
    one = lab.driver()
    lab.viewer()
    one.send("ask", request=1)
    assert one.latest("pages") == {"type": "pages", "driving": 1, "watching": 1}


def test_a_state_comes_once_a_second_and_on_change(lab):
    visit = lab.driver()
    lab.wait(1.0, visit)
    visit.got.clear()
    lab.wait(3.0, visit)
    states = [one for one in visit.got if one["type"] == "state" and one["robot"] == "anna"]
    assert 3 <= len(states) <= 4
    assert states[-1]["link"] == "lost"
    assert states[-1]["since_s"] > states[0]["since_s"]


# What any page may send, sound or not.
JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner),
    max_leaves=6,
)
ROBOTS = st.sampled_from(["anna", "bert", "carl", None])
REQUESTS = st.integers(0, 9)
SOUND = st.one_of(
    st.fixed_dictionaries({"type": st.sampled_from(["ask", "take", "leave"]), "request": REQUESTS}),
    st.fixed_dictionaries({"type": st.just("give"), "page": st.integers(0, 9)}),
    st.fixed_dictionaries({"type": st.just("stop"), "robot": ROBOTS}),
    st.just({"type": "beat"}),
    st.fixed_dictionaries(
        {
            "type": st.just("do"),
            "request": REQUESTS,
            "robot": ROBOTS,
            "command": st.sampled_from(["start", "kick", "set", "preset", "record", "x"]),
            "arguments": JSON | st.just({"set": {"k": 2.0}}) | st.just({"mode": "phase"}),
        }
    ),
    st.fixed_dictionaries(
        {"type": st.just("hand"), "robot": ROBOTS, "wheel": JSON, "angle_rad": JSON}
    ),
)
JUNK = (
    st.text(max_size=30)
    | JSON.map(json.dumps)
    | SOUND.flatmap(
        lambda sound: st.dictionaries(st.sampled_from([*sound, "key"]), JSON).map(
            lambda odd: json.dumps({**sound, **odd})
        )
    )
)
STEPS = st.one_of(
    st.tuples(st.just("send"), st.integers(0, 4), SOUND.map(json.dumps) | JUNK),
    st.tuples(st.just("wait"), st.sampled_from([0.3, 1.2])),
    st.tuples(st.just("come"), st.sampled_from(["driver", "viewer", "stranger"]), JSON),
    st.tuples(st.just("go"), st.integers(0, 4)),
)


@given(st.lists(STEPS, max_size=25))
def test_whatever_pages_send_there_is_one_driver_and_a_stop_passes(steps):
    lab = QuietLab()
    visits = [lab.driver(), lab.viewer(), lab.driver()]
    for step in steps:
        before = lab.session.baton.driver
        match step:
            case ("wait", seconds):
                lab.wait(seconds)
            case ("come", kind, resume):
                key = {"driver": lab.keys.drive, "viewer": lab.keys.view}.get(kind, "x")
                visits.append(lab.stranger(key, resume=resume))
            case ("go", index) if index < len(visits):
                visits.pop(index).leave()
            case ("send", index, text) if index < len(visits):
                _send(lab, visits[index], text)
        assert_one_driver(lab, visits)
        if before is not None and lab.session.baton.driver is None:
            assert "abandon" in [one[0] for one in lab.anna.take()]


def _send(lab, visit, text):
    """Send, and check that robots are moved by their driver only, and that a stop passes."""
    for station in (lab.anna, lab.bert):
        station.take()
    visit.send_text(text)
    told = lab.anna.take()
    if any(one[0] in ("start", "kick", "set", "preset", "hand") and one[-1] for one in told):
        assert lab.session.baton.driver == visit.page.number
    stops = text == json.dumps({"type": "stop", "robot": None})
    if stops and visit.page.number and not visit.page.closed:
        assert told == [("stop",)]
    lab.anna.told = [one for one in told if one[0] == "abandon"]


def assert_one_driver(lab, visits):
    joined = [visit for visit in visits if visit.page.number and not visit.page.closed]
    drivers = [visit.page.number for visit in joined if visit.drives]
    assert len(drivers) <= 1
    assert all(number == lab.session.baton.driver for number in drivers)
