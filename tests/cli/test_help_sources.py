"""Where `kickctl help` looks: letters, messages of the robot, settings of sim://, and the docs."""

import re

import pytest

from host.commands import _help_tables as tables
from host.commands._help_places import split_words
from host.link.sim_settings import settings
from robot.ev3 import _CAUSES
from robot.motors import Battery
from robot.power import Power
from tests.cli.test_help import names  # noqa: F401 - a fixture
from tests.faults.rows import ROWS
from tests.lint.sources import ROOT


class Weak(Battery):
    """A battery of 5.9 V, which is low, or empty."""

    def __init__(self, warn_v, stop_v):
        self.warn_v, self.stop_v = warn_v, stop_v

    def voltage_v(self):
        return 5.9


LEFT, RIGHT = "left motor (outB)", "right motor (outC)"
LOOP = (
    "the loop was silent for 0.2 s or longer, and the watchdog stepped in and stopped the motors:"
    " was the machine busy with something else? Clear the fault to go on"
)
# As the robot prints them, and what the row of the guide has of them.
MESSAGES = [
    (f"{LEFT}: its cable came off: plug it in", "its cable came off"),
    *((f"{RIGHT}: {what}: {remedy}", what.split("(")[0]) for what, remedy in _CAUSES.values()),
    (Power(Weak(6.0, 5.0)).warning(), "the battery is low"),
    (Power(Weak(6.0, 6.0)).exhaustion(), "the battery is empty"),
    (f"{LEFT}: it does not stop: pull its cable out", "it does not stop"),
    (f"{LEFT}: a lego-ev3-m-motor is there: plug in a large motor, then clear the fault", "large"),
    ("the right motor's angle is no number: nan", "angle is no number"),
    ("the watchdog has ended (signal 9)", "the watchdog has ended"),
    ("'bert@lab-2' was silent for 2 s", "' was silent for"),
    (LOOP, "the loop was silent"),
    ("the brick's back button stopped it", "stopped it"),
    ("the robot's program failed (KeyError('k')); start it again", "the robot's program failed"),
    ("EIO", "(EIO)"),
    ("the watchdog has suddenly ended (signal 9)", "the watchdog has ended"),
    *((row.words, row.words) for row in ROWS if row.words),
]


@pytest.mark.parametrize(("message", "words"), MESSAGES)
def test_what_the_robot_says_leads_to_its_row_first(kickctl, message, words):
    first = kickctl("help", message)[1].splitlines()[0]
    assert first.startswith("what you see: ")
    assert set(split_words(words)) <= set(split_words(first))


def test_most_of_a_message_is_enough_and_is_said(kickctl):
    status, out, err = kickctl("help", "it", "says", "that", "the", "battery", "is", "empty", "!")
    assert status == 0
    assert out.startswith("what you see: the battery is empty")
    assert "most of them" in err
    assert kickctl("help", "purple", "elephants", "dance", "nowhere")[0] == 1


@pytest.mark.parametrize(
    ("typed", "first"),
    [
        ("tau", "tau, time constant"),
        ("a", "a, gain"),
        ("M", "M, torque"),
        ("F", "F_tan, tangential force"),
        ("f", "f, friction"),
        ("phi", "phi, angle of the wheel"),
        ("x1", "x1, x2, membrane potentials"),
        ("omega", "omega, speed of the wheel"),
        ("I", "I, moment of inertia"),
        ("k", "k, spring constant"),
    ],
)
def test_a_letter_means_what_the_model_says(names, typed, first):  # noqa: F811
    found = names(typed)
    assert found[0] == f"letter: {first}"
    own = re.compile(rf"kickctl params set {typed}(_s)?=")
    parameters = [at for at, name in enumerate(found) if own.match(name)]
    options = [at for at, name in enumerate(found) if name.partition(" --")[2] == typed]
    assert max(parameters, default=0) < min(options, default=len(found))


def test_letters_are_those_of_the_page_of_the_model():
    page = (ROOT / "docs" / "model.md").read_text(encoding="utf-8")
    rows = [row for block in tables._LETTERS.findall(page) for row in block.splitlines()[2:]]
    assert len(rows) == len(list(tables.letters())) > 10


@pytest.mark.parametrize("setting", settings(), ids=lambda setting: setting.name)
def test_a_setting_of_the_simulated_robot_is_found_by_its_name(kickctl, setting):
    out = kickctl("help", setting.name)[1]
    assert f"sim://?{setting.name}=VALUE\n    {setting.doc}; {setting.span}" in out
    assert "docs/simulated-robot.md" in out


@pytest.mark.parametrize(
    ("word", "page"),
    [
        ("lesson", "docs/lesson.md"),
        ("worksheet", "docs/worksheet.md"),
        ("exercise", "docs/lab.md"),
        ("wifi", "robot/README.md"),
        ("letters", "docs/model.md"),
        ("QR", "docs/lab.md"),
    ],
)
def test_what_only_a_page_is_about_leads_to_the_page(names, word, page):  # noqa: F811
    assert names(word)[0] == f"page: {page}"


@pytest.mark.parametrize("index", [None, "# Somebody else's pages\n"])
def test_without_the_docs_it_says_that_they_may_know(kickctl, monkeypatch, tmp_path, index):
    if index is not None:
        (tmp_path / "docs").mkdir()
        (tmp_path / "docs" / "README.md").write_text(index, encoding="utf-8")
    pages = tables.pages
    monkeypatch.setattr(tables, "pages", lambda: pages(tmp_path))
    status, out, err = kickctl("help", "worksheet")
    assert (status, out) == (1, "")
    assert "the search of the docs may know more" in err
    assert "did you mean" not in err


@pytest.mark.parametrize(
    ("typed", "guess"),
    [
        ("workshet", "worksheet"),
        ("bumpr", "bumper"),
        ("xylophone", None),
        ("per cable off in", None),
    ],
)
def test_only_close_words_are_guessed(kickctl, typed, guess):
    err = kickctl("help", typed)[2]
    assert (f"did you mean {guess}?" in err) if guess else ("did you mean" not in err)


def test_names_of_many_places_can_be_told_apart_and_are_sorted(kickctl):
    out = " ".join(kickctl("help", "kick")[1].split())
    ids = re.search(r" claim: ([A-Z0-9; ]+) kickctl", out)[1].split("; ")
    assert ids == sorted(ids, key=lambda one: (one[0], int(one[1:])))
    assert "; it says it is running, but the wheels stand still; " in out
