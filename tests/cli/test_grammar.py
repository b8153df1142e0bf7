"""No command line, however odd, ends in a traceback; with --json each is one JSON object."""

import json
import subprocess
import sys

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from host import cli
from host.cli import VERBS, main, make_parser
from host.commands._terminal import show
from tests.lint.sources import ROOT

# Verbs that do little, and so may run; the others are only parsed.
QUICK = (
    "status",
    "stop",
    "start",
    "clear",
    "params",
    "log",
    "record",
    "watch",
    "kick",
    "body",
    "discover",
    "theory",
    "experiment",
    "reproduce",
    "deploy",
)
ODD = (
    "",
    "-",
    "--",
    "-1",
    "0",
    "0.03",
    "nan",
    "inf",
    "-inf",
    "1e400",
    "1e-400",
    "9" * 5000,
    "\u00b2",
    "\u0661",
    "\udcff",
    "a" * 300,
    "../..",
    "/",
    "/dev/null",
    "/dev/null/file",
    "%s",
    "{}",
    "=",
    "k=",
    "k=nan",
    "k=1e400",
    "=2",
    "\n",
    "\u202e",
    "sim://?seed=\u00b2",
    "sim://?k=nan",
    "sim://name",
    "--out",
    "--json=1",
    "--seed=\u00b2",
    "--set=k",
    "--brick=",
    "--token=/dev/null",
    "--out=--",
    "--seconds=--",
    "--ticks=--",
    "--ticks=1_0",
    "--seconds=1e308",
    "--value=\u0661",
    "--trails",
    "--bricks",
    "1_0",
    "1e308",
)
USUAL = (
    "--json",
    "--seed",
    "--set",
    "--brick",
    "sim://",
    "--out",
    "--mode",
    "phase",
    "pulse",
    "jump",
    "--ticks",
    "--shift",
    "-3pi/4",
    "--param",
    "--value",
    "--now",
    "list",
    "get",
    "set",
    "export",
    "replay",
    "recover",
    "pull",
    "k=2",
    "k",
    "car",
    "--time",
    "--help",
    "--version",
)
WORDS = st.sampled_from(ODD + USUAL) | st.text(st.characters(exclude_characters="\0"), max_size=6)


@pytest.fixture
def short(monkeypatch):
    """Nobody waits for long: what is recorded or watched lasts for a moment."""
    from host.client.robot import Robot

    wait = Robot.wait
    monkeypatch.setattr(
        Robot, "wait", lambda self, seconds, until=None: wait(self, min(seconds, 0.1), until)
    )
    monkeypatch.setattr("host.commands._watch_lines.REFRESH_S", 0.03)


@pytest.fixture
def stubbed(short, monkeypatch):
    """Verbs that last answer at once."""

    def run(options):
        if options.json:
            show({})
        return 0

    for verb in ("body", "theory", "experiment", "reproduce", "deploy", "watch"):
        monkeypatch.setattr(f"host.commands.{verb}.run", run)
    monkeypatch.setattr("host.link.discovery.look_around", lambda seconds: [])


def check(arguments, capsys):
    """Run kickctl: words, no traceback, a known exit status, and one object with --json."""
    status = main(arguments)
    out, err = capsys.readouterr()
    assert status in {0, 1, 2, 3, 4, 5}
    assert status == 0 or err
    if cli.asks_for_json(arguments):
        answer = json.loads(out)
        assert isinstance(answer, dict)
        assert answer.get("error", {"status": 0})["status"] == status


@settings(
    max_examples=300,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(
    before=st.lists(WORDS, max_size=2),
    verb=st.sampled_from(QUICK),
    after=st.lists(WORDS, max_size=5),
)
def test_any_command_line_is_answered_in_words(kickctl, capsys, stubbed, before, verb, after):
    check([*before, verb, *after], capsys)


@settings(
    max_examples=300,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(verb=st.sampled_from(VERBS), words=st.lists(WORDS, max_size=6))
def test_any_command_line_is_parsed_or_refused(verb, words):
    from host.errors import WrongUse

    parser = make_parser()
    try:
        options = parser.parse_args([verb, *words])
    except (WrongUse, SystemExit):
        return
    assert options.verb == verb


@pytest.mark.parametrize("word", ODD)
@pytest.mark.parametrize(
    "line",
    [
        ("status", "--brick", "{}"),
        ("status", "--seed", "{}"),
        ("status", "--set", "{}"),
        ("status", "--token", "{}"),
        ("params", "get", "{}"),
        ("params", "set", "{}"),
        ("record", "{}"),
        ("record", "0.03", "--out", "{}"),
        ("log", "list", "{}"),
        ("log", "replay", "{}"),
        ("log", "export", "{}"),
        ("log", "recover", "{}"),
        ("kick", "--mode", "phase", "--shift", "{}"),
        ("kick", "--mode", "pulse", "--param", "k", "--value", "{}"),
        ("reproduce", "--only", "{}"),
        ("experiment", "timeline", "--brick", "{}", "--scheduler", "nowhere"),
    ],
    ids=" ".join,
)
def test_odd_values_are_answered_in_words(kickctl, capsys, short, line, word):
    if word in ("", "sim://?k=nan") and line[0] in ("experiment", "reproduce"):
        word = "nothing"  # which means the simulated robot, or all claims
    check([part.replace("{}", word) for part in line] + ["--json"], capsys)


def test_a_stop_imports_next_to_nothing():
    """It must not wait for what other verbs need."""
    program = (
        "import sys; from host.cli import main; main(['--brick', 'tcp://127.0.0.1:1', 'stop']);"
        "print(*sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True
    )
    modules = set(done.stdout.split())
    assert "host.client.stop" in modules
    foreign = {name.partition(".")[0] for name in modules} & {"numpy", "rich", "zeroconf", "mcap"}
    assert foreign == set()
    others = ("asyncio", "dataclasses", "host.client.robot", "host.commands.kick", "robot.session")
    assert [name for name in others if name in modules] == []


def test_a_wrong_verb_and_help_still_know_all_verbs(kickctl):
    assert "did you mean stop?" in kickctl("stpo")[2]
    assert "did you mean status?" in kickctl("stat")[2]
    assert "blink its lights" in " ".join(kickctl("--help", "stop")[1].split())
    assert kickctl("--name", "kick")[0] == 2
