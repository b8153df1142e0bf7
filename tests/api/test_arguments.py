"""Arguments of the wrong kind: each is refused in words, and nothing has changed on the robot."""

import inspect
import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import kickctl
from tests.link.machines import RigLink
from tests.lint.sources import ROOT
from tests.rig import Rig


class Odd:
    """A stranger to everything, also to being printed."""

    def __repr__(self):
        raise RuntimeError("no words")


ROUND = []
ROUND.append(ROUND)
NO_TEXT = (5, 1.5, b"text", True, None, [], {}, Odd(), object, ROUND)
NO_SECONDS = ("1", None, -1, float("nan"), -float("inf"), True, b"1", [], Odd(), 1j, 10**400)
NO_FUNCTION = (3, "print", b"", [], Odd())
NO_PATH = (5, 1.5, b"path", True, [], Odd(), "", "a\0b")
NO_SEED = ("1", 1.5, -1, True, b"1", [], Odd(), 10**40, 10**5000)
NO_NAME = ("", " ", "x" * 41, "x" * 100_000, "a\x1b[2J", "a\n")
NO_ADDRESS = (5, b"sim://", True, [], {}, Odd(), "", "sim", "sim://?k=2&k=3", "sim://?seed=1e3")
NO_VALUE = (b"1", [Odd()], {5: 1}, Odd(), 1j, 10**5000, ROUND, float("nan"), "x" * 100_000)

# (function, argument, what it cannot be): one row for each argument that a person gives.
TABLE = [
    *(
        (name, argument, values)
        for name in ("connect", "Robot.connect")
        for argument, values in {
            "uri": NO_ADDRESS,
            "seed": NO_SEED,
            "token": NO_PATH,
            "name": (*(value for value in NO_TEXT if value is not None), *NO_NAME),
        }.items()
    ),
    *(
        ("run_experiment", argument, values)
        for argument, values in {
            "name": (*NO_TEXT, "", "nosuch"),
            "uri": NO_ADDRESS,
            "seed": NO_SEED,
            "token": NO_PATH,
            "out": NO_PATH,
            "scheduler": (5, b"", [], ""),
            "say": NO_FUNCTION,
            "trials": (
                b"5",
                True,
                None,
                [],
                Odd(),
                ROUND,
                "1",
                0,
                1.5,
                -1,
                10**9,
                10**5000,
                float("nan"),
                float("inf"),
            ),
            "nosuch": (1,),
        }.items()
    ),
    ("Robot.wait", "seconds", NO_SECONDS),
    ("Robot.wait", "until", NO_FUNCTION),
    ("Robot.pump", "timeout_s", NO_SECONDS),
    ("Robot.record", "seconds", NO_SECONDS),
    ("Robot.records", "seconds", NO_SECONDS),
    ("Robot.on_record", "callback", (*NO_FUNCTION, None)),
    ("Robot.add_tap", "tap", (*NO_TEXT, "tap")),
    ("Robot.pull", "tap", (*NO_TEXT, "tap")),
    ("Robot.describe", "table", (*NO_TEXT, "", "nosuch")),
    ("Robot.request", "command", (*NO_TEXT, "", "nosuch")),
    ("Robot.request", "arguments", (5, "x", b"x", [1], {"id": 1}, {"do": "stop"}, {5: 1}, Odd())),
    ("Robot.command", "command", (*NO_TEXT, "", "nosuch")),
    ("Robot.command", "set", (*NO_VALUE, *NO_TEXT)),
    ("Robot.command", "id", (1,)),
    ("Robot.command", "do", ("stop",)),
    ("Robot.set", "k", (*NO_VALUE, "2", "x", -1, None, True, [], 10**400)),
    ("Robot.set", "nosuch", (1,)),
    *(
        (name, argument, values)
        for name in ("Robot.kick", "Robot.kick_and_watch")
        for argument, values in {
            "mode": (*NO_TEXT, "", "nosuch"),
            "ticks": (*NO_VALUE, "4", 0, -1, 1.5, True, [], 10**400),
            "wheel": (*NO_VALUE, "", "middle", 3, True, []),
            "shift": (*NO_VALUE, "1", True, [], 100.0),
        }.items()
    ),
    ("Robot.kick", "id", (*NO_VALUE, 5, "", [])),
    ("Robot.kick", "nosuch", (1,)),
    ("Log", "info", (5, "x", b"x", [1], True, {5: 1}, {"x": Odd()}, {"x": ROUND}, Odd())),
    ("Log.take_records", "records", (5, "x", None, [5], Odd(), {})),
    ("Log.take_event", "event", (5, "x", None, [], {}, {"event": 5}, Odd())),
    ("Log.play", "tap", (*NO_TEXT, "tap")),
    ("Log.column", "name", (*NO_TEXT, "", "nosuch")),
    ("Log.show", "from_s", NO_SECONDS),
    ("Log.show", "to_s", NO_SECONDS),
    ("Log.omega", "side", (*NO_TEXT, "", "middle", "both")),
    *(
        (f"Log.{name}", "path", (*NO_PATH, None))
        for name in ("save", "load", "to_csv", "to_npz", "to_parquet")
    ),
]
OTHERS = {
    "run_experiment": {"name": "timeline"},
    "Robot.wait": {"seconds": 0.0},
    "Robot.request": {"command": "status"},
    "Robot.command": {"command": "set"},
    "Robot.kick": {"mode": "phase"},
    "Robot.kick_and_watch": {"mode": "phase", "now": True},
}
# What takes no argument of a person's, or any: a context manager's, and those for taking things
# back, which do nothing for what they do not know.
NOTHING_TO_REFUSE = {"Robot.remove_tap", "Robot.gain_control", "Robot.lose_control"}


def named(place):
    value = kickctl
    for name in place.split("."):
        value = getattr(value, name)
    return value


def own_arguments(place):
    return [name for name in inspect.signature(named(place)).parameters if name != "self"]


def test_every_public_function_is_in_the_table():
    places = [
        f"{kind}.{name}"
        for kind in ("Robot", "Log")
        for name, value in inspect.getmembers(getattr(kickctl, kind), inspect.isroutine)
        if not name.startswith("_")
    ]
    missing = {
        place for place in (*places, "connect", "run_experiment") if own_arguments(place)
    } - {place for place, _, _ in TABLE}
    assert missing <= NOTHING_TO_REFUSE


def state(link):
    """Everything about the robot that a request could change, but for who controls it."""
    rig = Rig.__new__(Rig)
    rig.loop, rig.motors = link.loop, link.brick.motors
    found = rig.fingerprint()
    for passing in ("lease", "time", "wheels", "motors", "box", "counts"):
        del found[passing]
    return found


@pytest.fixture(scope="module")
def robot():
    link = RigLink()
    with kickctl.Robot(link, link.token) as robot:
        robot.wait(0.5)
        yield robot


@pytest.mark.parametrize(
    ("place", "argument", "values"), TABLE, ids=[f"{place} {name}" for place, name, _ in TABLE]
)
def test_wrong_arguments_are_refused_in_words(robot, place, argument, values):
    function = named(place)
    if place.startswith("Robot.") and place != "Robot.connect":
        function = getattr(robot, place.removeprefix("Robot."))
    elif place.startswith("Log.") and place != "Log.load":
        function = getattr(kickctl.Log(), place.removeprefix("Log."))
    before, journal = state(robot.link), len(robot.link.events())
    for value in values:
        if value is None and argument in ("ticks", "wheel", "shift", "seed", "uri", "token"):
            continue  # as if it were left out
        with pytest.raises(kickctl.WrongUse) as caught:
            function(**{**OTHERS.get(place, {}), argument: value})
        assert caught.value.message.isprintable()
        assert len(caught.value.message) < 500
        assert caught.value.hint
    assert state(robot.link) == before
    assert len(robot.link.events()) == journal
    assert robot.status()["state"] == "running"


SPECIAL = {  # by names, since hypothesis prints what it chooses from
    "odd": Odd(),
    "a class": object,
    "round": ROUND,
    "long": 10**5000,
    "numpy": np.int64(-1),
    "an array": np.array([1]),
}
ANYTHING = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(max_size=5)
    | st.binary(max_size=5)
    | st.complex_numbers()
    | st.sampled_from(sorted(SPECIAL)).map(lambda name: SPECIAL[name]),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3) | st.integers(), inner)
    ),
    max_leaves=5,
)
# What these values could do to the robot, it may do: k=2 is a parameter.
FUZZED = [
    (place, argument)
    for place, argument, _ in TABLE
    if place.startswith("Robot.") and (place, argument) != ("Robot.wait", "seconds")
]


@given(st.sampled_from(FUZZED), ANYTHING)
def test_nothing_but_kickctl_error_comes_of_any_value(robot, place, value):
    name, argument = place
    seconds = name in ("Robot.record", "Robot.pump", "Robot.records") and isinstance(value, float)
    if seconds or name == "Robot.connect" or argument in ("id", "do", "nosuch"):
        return  # a long time is no mistake
    function = getattr(robot, name.removeprefix("Robot."))
    if isinstance(value, int) and name in ("Robot.record", "Robot.pump"):
        return
    try:
        function(**{**OTHERS.get(name, {}), argument: value})
    except kickctl.KickctlError as error:
        assert error.message.isprintable()


def test_a_log_that_was_refused_something_is_as_it_was():
    log = kickctl.Log({"brick": "sim://", "k": np.float64(2)})
    for take in (log.take_records, log.take_event):
        with pytest.raises(kickctl.WrongUse):
            take([5])
    assert (len(log), log.events, log.places) == (0, [], [])
    assert log.info == {"brick": "sim://", "k": 2.0}
    assert kickctl.Log.load(log.save("a.mcap")).info == log.info


def test_numbers_of_numpy_are_numbers():
    with kickctl.connect("sim://", seed=np.int64(3)) as robot:
        assert robot.hello["seed"] == 3
        robot.set(k=np.int64(2), tau_s=np.float32(1))
        robot.wait(np.float64(0.1))
        assert robot.status()["params"]["k"] == 2.0
        assert robot.kick("phase", ticks=np.int64(4)) > 0


@pytest.mark.parametrize("token", ["/dev/full", "/dev/null", "/dev", "nosuch"])
def test_what_is_no_token_file_is_named_and_not_to_be_closed_to_others(token):
    with pytest.raises(kickctl.RefusedByRobot) as caught:
        kickctl.connect("tcp://127.0.0.1:9", token=token)
    assert token in caught.value.message
    assert "chmod" not in caught.value.message + caught.value.hint


def test_a_path_may_be_a_path(tmp_path):
    with pytest.raises(kickctl.RefusedByRobot, match="no token"):
        empty = tmp_path / "empty"
        empty.touch(mode=0o600)
        kickctl.connect("tcp://127.0.0.1:9", token=empty)


@pytest.mark.parametrize(("link", "token"), [(5, None), ("sim://", None), (None, b""), ("", "x")])
def test_a_robot_is_made_by_connect(link, token):
    with pytest.raises(kickctl.WrongUse, match="link") as caught:
        kickctl.Robot(link, token)
    assert "connect" in caught.value.hint


def test_a_connection_takes_the_bytes_of_a_token():
    link = RigLink()
    with pytest.raises(kickctl.WrongUse, match="token"):
        kickctl.Robot(link, "00" * 32)


def test_errors_of_logs_are_part_of_the_api(tmp_path):
    with pytest.raises(kickctl.LogError) as caught:
        kickctl.Log.load(tmp_path / "nosuch.mcap")
    assert isinstance(caught.value, kickctl.WrongUse)


def test_messages_show_what_cannot_be_printed():
    for address in (
        "tcp://h\x1b[2J",
        "tcp://\udcff",
        "sim://?k%0a=1",
        "ssh://h?x%1b=1",
        "ssh://\a",
    ):
        with pytest.raises(kickctl.WrongUse) as caught:
            kickctl.connect(address)
        assert caught.value.message.isprintable()
        assert "\\" in caught.value.message
        json.dumps(caught.value.message).encode("ascii")


@pytest.mark.parametrize("file", [ROOT / "kickctl" / "robots.py"])
def test_the_arguments_of_connect_are_explained_in_one_place(file):
    assert "token file" not in Path(file).read_text(encoding="utf-8")
    assert inspect.getdoc(kickctl.connect) == inspect.getdoc(kickctl.Robot.connect)
