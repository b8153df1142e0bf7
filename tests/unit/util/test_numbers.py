"""Values of options that can be swept: one, several, and evenly spaced ones."""

import argparse

import pytest

from host.util.numbers import Values


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("0.25", 0.25),
        ("0.1,0.25,0.5", [0.1, 0.25, 0.5]),
        ("0.1:1:10", [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]),
        ("1:0:3,2", [1.0, 0.5, 0.0, 2.0]),
    ],
)
def test_numbers_are_separated_by_commas_or_evenly_spaced_with_both_ends(text, values):
    assert Values(least=0.0, most=2.0)(text) == values


def test_whole_numbers_stay_whole():
    values = Values(whole=True)("1:9:5")
    assert values == [1, 3, 5, 7, 9]
    assert {type(value) for value in values} == {int}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("0.1,,1", "cannot be ''"),
        ("0.1,3", "cannot be 3; give a number, from 0 to 2"),
        ("0:1", "start:stop:count"),
        ("0:1:2:3", "start:stop:count"),
        ("0:1:1", "from 2 to"),
        ("0:1:2.5", "from 2 to"),
        ("0:3:4", "cannot be 3"),
        ("a:1:2", "cannot be 'a'"),
    ],
)
def test_other_ranges_are_refused_in_words(text, words):
    with pytest.raises(argparse.ArgumentTypeError, match=words):
        Values(least=0.0, most=2.0)(text)


def test_whole_numbers_between_steps_are_refused():
    with pytest.raises(argparse.ArgumentTypeError, match="whole steps"):
        Values(whole=True)("1:4:3")
