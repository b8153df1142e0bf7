"""`kickctl help WORD` finds what people look for by its name or by what it is."""

import errno
import json
import sys

import pytest

from host.cli import VERBS
from host.experiments.registry import TABLE as EXPERIMENTS
from host.figures.theory import lines
from host.theory.studies.registry import TABLE as STUDIES
from robot.params import TABLE as PARAMS
from robot.record import CHANNELS
from tests.cli.test_lost_answers import Unwritable


@pytest.fixture
def names(kickctl):
    """The names of the places in which words are found."""

    def find(*words):
        status, out, err = kickctl("help", "--json", *words)
        assert (status, err) == (0, "")
        return [place["name"] for place in json.loads(out)["places"]]

    return find


@pytest.mark.parametrize(
    ("words", "first"),
    [
        (("hysteresis",), "word: hysteresis"),
        (("crisis",), "word: crisis"),
        (("Hopf",), "word: Hopf bifurcation"),
        (("torus",), "word: Neimark-Sacker bifurcation, torus bifurcation"),
        (("Lyapunov", "point"), "kickctl theory lyapunov"),
        (("kick",), "word: kick"),
        (("rod_lag_s",), "kickctl params set rod_lag_s=VALUE"),
        (("left", "torque"), "column of logs: left_torque"),
        (("R5",), "claim R5"),
        (("k",), "letter: k, spring constant"),
        (("gain",), "letter: a, gain"),
        (("grip",), "sim://?grip=VALUE"),
        (("seed",), "word: seed, random seed"),
        (("minutes",), "kickctl experiment NAME --minutes"),
        (("walls", "simulated", "distance"), "kickctl lab --walls"),
        (("recover", "damaged"), "kickctl log recover"),
        (("cable", "off"), "what you see: fault: left motor (outB): its cable came off"),
        (("motor", "blocked"), "what you see: it hums and does not start"),
    ],
)
def test_the_first_place_is_what_is_meant(names, words, first):
    assert names(*words)[0] == first


def test_everything_with_a_name_is_found_by_it(names):
    every = (
        [f"kickctl {name}" for name in VERBS]
        + [f"kickctl experiment {name}" for name in EXPERIMENTS]
        + [f"kickctl theory {name}" for name in STUDIES]
        + [f"kickctl params set {name}=VALUE" for name in PARAMS]
        + [f"column of logs: {channel.name}" for channel in CHANNELS]
        + [
            f"claim {claim}"
            for entry in (*EXPERIMENTS.values(), *STUDIES.values())
            for claim in entry.claims
        ]
    )
    lost = [place for place in every if place not in names(place.split()[-1].partition("=")[0])]
    assert lost == []


def test_all_words_must_be_found_and_a_beginning_is_enough(names):
    both = names("tau", "membrane")
    assert both
    assert set(both) < set(names("tau"))
    assert set(names("bifurcation")) <= set(names("bifurc"))


def test_many_places_are_named_below_the_first_ones(kickctl):
    status, out, _ = kickctl("help", "k")
    first, what, *_ = lines = out.splitlines()
    assert (status, first) == (0, "letter: k, spring constant")
    assert "docs/model.md" in what
    assert len(lines) < 30
    assert any(line.endswith("more; one more word finds fewer:") for line in lines)


def test_a_word_is_explained_with_its_command_and_page(kickctl):
    _, out, _ = kickctl("help", "crisis")
    assert out.splitlines()[1] == (
        "    a chaotic attractor touches the boundary of its basin; beyond this value of the"
        " parameter chaos is a transient, which ends; see kickctl theory lyapunov-line, and"
        " docs/theory.md"
    )


def test_words_of_the_figures_of_lines_are_explained(names):
    """Those of the legend."""
    labels = [label for _, _, label in lines._LINES.values()]
    labels += [label for _, label in lines._MARKERS.values() if not label.startswith("crosses")]
    words = {label.partition(",")[0].removesuffix("s") for label in labels}
    assert [word for word in words if not names(word)[0].startswith("word: ")] == []


def test_a_claim_is_said_in_its_sentence(kickctl):
    assert "rest and locomotion coexist" in kickctl("help", "R6")[1]


def test_without_a_word_it_is_the_help_of_the_program(kickctl):
    assert kickctl("help") == kickctl("--help")


def test_a_reader_who_has_seen_enough_hears_nothing(kickctl, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(sys, "stdout", Unwritable(errno.EPIPE))
        assert kickctl("help", "k")[2] == ""


@pytest.mark.parametrize(
    ("word", "guess"), [("hystersis", "did you mean hysteresis?"), ("---", "fewer words")]
)
def test_what_is_not_there_is_said_with_a_guess(kickctl, word, guess):
    status, out, err = kickctl("help", "--", word)
    assert (status, out) == (1, "")
    assert f"nothing about '{word}'" in err
    assert guess in err
