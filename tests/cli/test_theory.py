"""kickctl theory: what its commands answer, and how they refuse."""

from __future__ import annotations

import json
import subprocess
import sys
import textwrap
from math import pi

import pytest

from host.theory.analysis.hopf import hopf
from host.theory.model.wheel import Wheel


def test_the_command_lists_eight_fixpoints(kickctl):
    status, out, _ = kickctl("theory", "fixpoints", "--k", "1.4", "--tau", "0.25", "--json")
    points = json.loads(out)["fixpoints"]
    assert status == 0
    assert [point["phi"] for point in points] == pytest.approx([n * pi / 4 for n in range(8)])
    assert [point["stable"] for point in points] == [True, False] * 4
    assert all(len(point["eigenvalues"]) == 4 for point in points)
    assert sum(re for re, _ in points[3]["eigenvalues"]) == pytest.approx(-2 / 0.25 - 0.5 / 0.05)


def test_two_wheels_have_sixteen_stable_states_below_the_line_and_none_above(kickctl):
    for k, stable, verdict in (("1.4", 16, "holds"), ("1.85", 0, "undecided")):
        status, out, _ = kickctl("theory", "fixpoints", "--k", k)
        assert status == 0
        sentence = f"two wheels have 16 non-moving states. Measured: {stable} stable states"
        assert f"M2 {verdict}: {sentence}" in out


@pytest.mark.parametrize(
    ("arguments", "claims"),
    [
        (("fixpoints", "--a", "3"), ("M1", "M2")),
        (("hopf", "--tau", "1"), ("M3",)),
    ],
)
def test_at_other_constants_the_claims_are_undecided_and_the_command_succeeds(
    kickctl, arguments, claims
):
    status, out, _ = kickctl("theory", *arguments)
    assert status == 0
    for number in claims:
        assert f"{number} undecided: " in out
    assert out.count("the claim is made for ") == len(claims)


def test_the_command_gives_the_hopf_point(kickctl):
    status, out, _ = kickctl("theory", "hopf", "--tau", "1", "--json")
    found = json.loads(out)
    assert status == 0
    assert found["k_hopf"] == pytest.approx(0.4725, abs=5e-5)  # AUTO's
    assert found["k_estimate"] == 0.25
    assert found["l1"] < 0
    assert found["accuracy"]["closed_form_against_eigenvalues"] < 1e-10
    assert found["omega_hopf"] == pytest.approx(hopf(Wheel(tau=1.0)).omega)


def test_the_answer_is_a_table_and_json_has_the_same(kickctl):
    status, out, _ = kickctl("theory", "portrait", "--k", "1.4")
    assert "  phase at k = 1.4         S, at rest\n" in out
    assert (status, out.count("the claim is made for ")) == (0, 1)
    assert "M4 undecided: " in out
    answers = json.loads(kickctl("theory", "portrait", "--k", "1.4", "--json")[1])["answers"]
    assert answers[0]["name"] == "rest is unstable from k"
    assert answers[0]["value"] == pytest.approx(hopf(Wheel()).k)
    assert answers[1]["value"] == "S, at rest"


@pytest.mark.parametrize(
    "arguments",
    [
        ("hopf", "--f", "0"),
        ("hopf", "--tau", "0"),
        ("fixpoints", "--k", "nan"),
        ("fixpoints", "--I", "0"),
        ("branch", "--a", "0"),
        ("branch", "--f", "0"),
        ("branch", "--along", "f", "--f", "0"),
        ("branch", "--along", "tau", "--k", "0"),
        ("branch", "--tau", "1e-6"),
        ("portrait", "--f", "0"),
        ("escape", "--f", "0", "--start", "roll", "--noise", "0.1"),
        ("phase-diagram", "--I", "1e-8"),
        ("phase-diagram", "--f", "0"),
        ("lines", "--f", "0"),
        ("lines", "--x", "tau"),
        ("lines", "--rods", "1"),
        ("lines", "--y", "I", "--y-to", "1e-6"),
        ("lyapunov", "--f", "0"),
        ("lyapunov-line", "--f", "0"),
        ("section", "--a", "0"),
        ("edge", "--k", "1"),
        ("orbit", "--from", "3", "--to", "2"),
        ("orbit", "--over", "f", "--from", "0"),
        ("tick", "--f", "0"),
        ("tick", "--tick", "1e-5"),
    ],
)
def test_degenerate_input_is_refused_in_words_before_anything_is_computed(kickctl, arguments):
    status, _, err = kickctl("theory", *arguments)
    assert status == 2
    assert "Traceback" not in err
    assert "cells complete" not in err
    assert err.count("kickctl:") == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("theory", "hopf", "--noise", "0.1"), "kickctl theory escape --noise"),
        (("theory", "section", "--angle-noise", "0.1"), "kickctl theory escape --angle-noise"),
        (("experiment", "chaos", "--rods", "1"), "kickctl theory hopf --rods 1"),
        (("experiment", "car-slope", "--bounded", "1"), "kickctl theory portrait --bounded 1"),
    ],
)
def test_an_option_of_other_runs_is_refused_with_the_place_where_it_is(kickctl, arguments, words):
    status, _, err = kickctl(*arguments)
    assert status == 2
    assert words in err


def test_an_interrupt_in_a_destructor_comes_again():
    script = textwrap.dedent("""
        import os, signal, sys, time
        from host import cli

        class Doomed:
            def __del__(self):
                os.kill(os.getpid(), signal.SIGTERM)
                time.sleep(0.01)

        def run(options):
            print("begun", flush=True)
            Doomed()
            for _ in range(1000):
                time.sleep(0.01)
            print("not interrupted", flush=True)
            return 0

        import host.commands.discover as verb
        verb.run = run
        sys.exit(cli.main(["discover"]))
    """)
    found = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=False
    )
    assert (found.returncode, found.stdout) == (130, "begun\n")
    assert found.stderr == "kickctl: interrupted\n"
