"""What holds for every verb: errors in JSON, options that it does not use, hints, and units."""

import argparse
import json
import re
import shlex

import pytest

from host.cli import VERBS, make_parser
from host.client.robot import Robot
from host.commands import _hints, discover
from host.errors import NoLink
from host.util.numbers import Number
from tests.lint.sources import ROOT


def commands(parser, words=()):
    """(words, parser) of every command, such as ('log',) and ('log', 'list')."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, below in action.choices.items():
                yield (*words, name), below
                yield from commands(below, (*words, name))


COMMANDS = dict(commands(make_parser()))
# Those that can be run.
LEAVES = {words: parser for words, parser in COMMANDS.items() if not dict(commands(parser))}
# What a command needs to be parsed at all.
NEEDS = {
    ("kick",): ("--mode", "phase"),
    ("plan",): ("--to", "forward"),
    ("drive",): ("forward",),
    ("params",): ("list",),
    ("record",): ("1",),
    ("body",): ("car",),
    ("log", "export"): ("a.mcap",),
    ("log", "replay"): ("a.mcap",),
    ("log", "recover"): ("a.mcap",),
    ("log", "plot"): ("a.mcap",),
    ("log", "film"): ("a.mcap",),
    ("robots",): ("list",),
    ("help",): ("k",),
}
UNUSED = [
    (words, option)
    for words, parser in LEAVES.items()
    for option in ("--brick", "--token", "--set", "--seed", "--name")
    if option[2:] not in parser.get_default("used")
]


def refused(kickctl, *arguments):
    """The error of a command line that is wrong."""
    status, out, err = kickctl(*arguments, "--json")
    assert len(out.splitlines()) == 1
    error = json.loads(out)["error"]
    assert status == error["status"] == 2
    assert error["message"] in err
    return error


@pytest.mark.parametrize("words", LEAVES, ids=" ".join)
def test_a_wrong_word_is_one_object_of_the_verb_itself(kickctl, words):
    needs = NEEDS.get(words, ())
    error = refused(kickctl, *words, *needs, "--nothing-like-this")
    assert f"`kickctl {' '.join(words)}` has no option '--nothing-like-this'" in error["message"]
    assert f"see kickctl {' '.join(words)} --help" in error["hint"]
    refused(kickctl, *words, *needs, "one", "two", "three", "--four")
    refused(kickctl, *words, *needs, "--seed", "\u00b2")


@pytest.mark.parametrize("words", LEAVES, ids=" ".join)
def test_a_mistyped_option_is_guessed(kickctl, words):
    own = [
        option
        for option, action in LEAVES[words]._option_string_actions.items()
        if len(option) > 5 and action.help is not argparse.SUPPRESS and option != "--help"
    ]
    for option in own:
        mistyped = option + "x"
        error = refused(kickctl, *words, *NEEDS.get(words, ()), mistyped)
        assert f"did you mean {option}?" in error["hint"]


@pytest.mark.parametrize(
    ("arguments", "guess"),
    [
        (("stauts",), "status"),
        (("experiment", "relibility"), "reliability"),
        (("theory", "hpof"), "hopf"),
        (("log", "lst"), "list"),
        (("kick", "--mode", "phse"), "phase"),
        (("kick", "--mode", "phase", "--wheel", "lefft"), "left"),
        (("experiment", "timeline", "--trails", "3"), "--trials"),
        (("theory", "phase-diagram", "--transi=3"), None),
    ],
)
def test_a_mistyped_name_is_guessed(kickctl, arguments, guess):
    if guess is None:  # argparse takes what can only mean one option
        assert make_parser().parse_args(arguments).transient == 3
    else:
        assert f"did you mean {guess}?" in refused(kickctl, *arguments)["hint"]


@pytest.mark.parametrize(("words", "option"), UNUSED)
def test_an_option_that_the_verb_does_not_use_is_refused(kickctl, words, option):
    value = {"--seed": "1", "--set": "k=2"}.get(option, "x")
    for line in (
        (*words, *NEEDS.get(words, ()), option, value),
        (option, value, *words, *NEEDS.get(words, ())),
    ):
        error = refused(kickctl, *line)
        assert error["message"].startswith(option)
        assert f"`kickctl {' '.join(words)}`" in error["message"]
        assert "leave it out" in error["hint"]
        assert "sim://" not in error["message"] + error["hint"]
    shown = {line.split()[0] for line in kickctl(*words, "--help")[1].splitlines() if line.split()}
    assert option not in shown


def test_the_unused_ones_are_those_that_are_meant():
    assert {(("theory", "hopf"), "--brick"), (("log", "list"), "--set")} <= set(UNUSED)
    assert not {words for words, _ in UNUSED} & {("kick",), ("stop",), ("rods",), ("log", "pull")}


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_the_help_ends_with_an_example_how_long_it_takes_and_a_page(words):
    (*_, ending) = COMMANDS[words].format_help().split("\n\n")
    lines = r"example:  kickctl (.+)\ntakes:    (.+)\npage:     (.+)\n"
    if words[0] == "theory":
        lines += "words:    kickctl help WORD .+\n"
    found = re.fullmatch(lines, ending)
    example, takes, page = found.groups()
    assert example.startswith(" ".join(words))
    make_parser().parse_args(shlex.split(example))
    assert re.match(r"(\d+ (to \d+ )?|half a |a )(s|minutes?|hours?)\b|less than 1 s|until", takes)
    assert (ROOT / page).is_file()


@pytest.mark.parametrize("words", LEAVES, ids=" ".join)
def test_every_number_has_its_unit_and_its_range_in_the_help(words):
    for action in LEAVES[words]._actions:
        if isinstance(action.type, Number) and action.help != argparse.SUPPRESS:
            assert action.help
            text = action.help.replace("%(default)s", "")
            unit = action.type.unit
            assert not unit or re.search(rf"\b{re.escape(unit)}\b", text), action.dest
            assert _says_what_it_counts(text), (action.dest, text)
            shown = " ".join(LEAVES[words].format_help().split())
            span = f"; {action.type.span()}" if action.type.span() else ""
            assert " ".join((action.help % vars(action) + span).split()) in shown
        else:
            assert action.type not in (int, float), action.dest


def _says_what_it_counts(text):
    units = (
        "s|rad|m|N|N m|minutes|control periods|cars|without unit|no unit|the unit (that|of)"
        "|whole number|number of \\w+|how many times"
    )
    return re.search(rf"\b({units})\b|N s/m|in units of", text)


@pytest.mark.parametrize(
    "text", ["\u00b2", "", "1_0", "nan", "inf", "1e400", "\u0661", "1 s", "0x1", "1e308"]
)
@pytest.mark.parametrize(
    "line",
    [
        ("record", "{}"),
        ("kick", "--mode", "phase", "--ticks={}"),
        ("kick", "--mode", "jump", "--variable", "x1", "--delta={}"),
        ("kick", "--mode", "phase", "--shift={}"),
        ("watch", "--seconds={}"),
        ("discover", "--seconds={}"),
        ("body", "car", "--time={}"),
        ("body", "train", "--cars={}"),
        ("experiment", "reliability", "--trials={}"),
        ("experiment", "chaos", "--minutes={}"),
        ("theory", "hopf", "--a={}"),
    ],
    ids=" ".join,
)
def test_what_is_no_number_is_refused_in_plain_words(kickctl, line, text):
    error = refused(kickctl, "--json", *(part.replace("{}", text) for part in line))
    assert re.search("cannot be|is not an angle", error["message"])
    assert re.search("give a (whole )?number|write it in rad", error["message"])
    assert not re.search("invalid|int value|float", error["message"])


@pytest.mark.parametrize("option", ["--ticks", "--value", "--out", "--seed", "--set", "--brick"])
def test_two_dashes_are_no_value(kickctl, option):
    verb = ("body", "car") if option == "--out" else ("kick", "--mode", "phase")
    assert "cannot be '--'" in refused(kickctl, *verb, f"{option}=--")["message"]


def test_a_setting_is_a_number_by_the_same_rules(kickctl):
    for value in ("1_0", "\u0662", "nan", "2\u00b2"):
        status, out, err = kickctl("params", "set", f"k={value}", "--json")
        assert status == json.loads(out)["error"]["status"] == 2
        assert re.search("k cannot be|no value", err)


@pytest.mark.parametrize("verb", VERBS)
def test_every_failure_has_an_error(kickctl, monkeypatch, verb):
    """A link that breaks at once, and nobody in the network: every status but 0 has its words."""

    def fail(*_, **__):
        raise NoLink("nobody is there", "look: kickctl status")

    monkeypatch.setattr("host.link.names.make_link", fail)
    monkeypatch.setattr("host.perform.robots.connect", fail)
    monkeypatch.setattr("host.link.discovery.look_around", lambda seconds: [])
    words = next(words for words in LEAVES if words[0] == verb)
    if verb in ("body", "theory", "deploy", "reproduce", "experiment", "lab", "foxglove"):
        return  # no robot, or one that may come later; and tests of their own
    status, out, _ = kickctl(*words, *NEEDS.get(words, ()), "--json")
    (line,) = out.splitlines()
    assert status == (json.loads(line)["error"]["status"] if "error" in json.loads(line) else 0)
    assert status or verb in ("log", "robots", "help")  # which list what is on this computer


def test_nobody_in_the_network_is_an_error(kickctl, monkeypatch):
    monkeypatch.setattr("host.link.discovery.look_around", lambda seconds: [])
    status, out, err = kickctl("discover", "--json")
    answer = json.loads(out)
    assert status == answer["error"]["status"] == 3
    assert answer["robots"] == []
    assert discover.WHAT_TO_TRY in err


@pytest.mark.parametrize(
    ("arguments", "status", "key"),
    [
        (("kick", "--mode", "phase", "--ticks", "1", "--seed", "5"), 1, "reversed"),
        (("status", "--brick", "tcp://127.0.0.1:1"), 3, None),
    ],
)
def test_an_answer_that_is_no_success_has_an_error_too(kickctl, arguments, status, key):
    done, out, _ = kickctl(*arguments, "--json")
    answer = json.loads(out)
    assert done == answer["error"]["status"] == status
    assert key is None or key in answer


def test_a_fault_is_an_error_of_the_status(kickctl, monkeypatch):
    status = Robot.status
    monkeypatch.setattr(
        Robot, "status", lambda self: {**status(self), "state": "fault", "reason": "a plug"}
    )
    done, out, err = kickctl("status", "--json", "--brick", "sim://")
    answer = json.loads(out)
    assert (done, answer["state"], answer["error"]["status"]) == (5, "fault", 5)
    assert "kickctl clear --brick sim://, kickctl start --brick sim://" in err


@pytest.mark.parametrize(
    ("text", "typed"),
    [
        ("`kickctl start`", "`kickctl start --brick 'tcp://h?x' --token t`"),
        ("kickctl clear, kickctl start", None),
        ("kickctl log pull", "kickctl log pull --brick 'tcp://h?x' --token t"),
        ("kickctl drive forward", "kickctl drive forward --brick 'tcp://h?x' --token t"),
        (
            "kickctl params set k=8.5, then look",
            "kickctl params set k=8.5 --brick 'tcp://h?x' --token t, then look",
        ),
        ("kickctl record 10.", "kickctl record 10 --brick 'tcp://h?x' --token t."),
        ("kickctl discover, kickctl log list", "kickctl discover, kickctl log list"),
        ("see kickctl params --help", "see kickctl params --help"),
        ("kickctl started", "kickctl started"),
        ("`kickctl stop --brick anna`", "`kickctl stop --brick anna`"),
        ("kickctl params set k=8 --brick anna", "kickctl params set k=8 --brick anna"),
    ],
)
def test_hints_name_the_robot_that_was_named(text, typed):
    _hints.name_robot(None, None)
    assert _hints.as_typed(text) == text
    _hints.name_robot("tcp://h?x", "t")
    try:
        named = _hints.as_typed(text)
    finally:
        _hints.name_robot(None, None)
    if typed is not None:
        assert named == typed
    else:
        assert named.count("--brick 'tcp://h?x'") == 2


def test_a_robot_of_the_environment_is_in_no_hint(kickctl, monkeypatch):
    monkeypatch.setenv("KICK_BRICK", "sim://?idle=1")
    assert "start it first: kickctl start\n" in kickctl("kick", "--mode", "phase")[2]
