"""What `kickctl VERB --help` says is true: its examples are accepted, its pages know the verb."""

import re

import pytest

from host.cli import VERBS, make_parser
from host.commands._help_notes import NOTES
from host.experiments.registry import TABLE as EXPERIMENTS
from host.runs.registry import complete_options, options_given
from host.theory.studies.registry import TABLE as STUDIES
from tests.cli.test_every_verb import COMMANDS
from tests.lint.sources import ROOT

TABLES = {"experiment": EXPERIMENTS, "theory": STUDIES}
SWEPT = {
    words: parser for words, parser in COMMANDS.items() if "make a sweep" in str(parser.epilog)
}


def test_all_runs_with_numbers_show_a_sweep():
    assert {("experiment", "starts"), ("experiment", "reliability"), ("theory", "hopf")} <= {*SWEPT}


@pytest.mark.parametrize("words", SWEPT, ids=" ".join)
def test_the_example_of_a_sweep_is_accepted(words):
    """By the option, and by the run."""
    examples = re.findall(r"(--[-\w]+) (\d\S*)", SWEPT[words].epilog)
    assert len(examples) == 2
    for example in examples:
        options = make_parser((words[0],)).parse_args([*words, *example])
        given = options_given(options, TABLES[words[0]][words[1]])
        complete_options(words[1], TABLES[words[0]][words[1]], given)
        assert [len(values) > 1 for values in given.values()] == [True]


def test_an_experiment_without_k_shows_an_option_that_it_has(kickctl):
    assert "--starts 50,100" in kickctl("experiment", "starts", "--help")[1]
    assert "--k 1,2,4" in kickctl("experiment", "reliability", "--help")[1]


@pytest.mark.parametrize("verb", VERBS)
def test_the_page_of_a_verb_knows_it(verb):
    page = (ROOT / NOTES[verb].page).read_text(encoding="utf-8")
    assert re.search(rf"\bkickctl\b[^\n]* {verb}\b|`{verb}\b|\| {verb} ", page)


def test_the_help_of_params_says_what_its_words_are(kickctl):
    out = " ".join(kickctl("params", "--help")[1].split())
    assert "kickctl params list shows all names with their units and ranges" in out
    positionals = [action for action in COMMANDS["params",]._actions if not action.option_strings]
    assert all(action.help for action in positionals)
