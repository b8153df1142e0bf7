"""Errors say what to do next, in a notebook's traceback and once in the command's words."""

import traceback

import pytest

from host.cli import main
from kickctl import WrongUse, connect


def test_a_traceback_shows_the_hint():
    with pytest.raises(WrongUse) as caught:
        connect("sim://?k=abc")
    assert caught.value.hint
    assert caught.value.hint in "".join(traceback.format_exception(caught.value))
    assert caught.value.hint not in str(caught.value)


def test_the_command_says_the_hint_once(capsys):
    status = main(["--brick", "sim://?k=abc", "status"])
    with pytest.raises(WrongUse) as caught:
        connect("sim://?k=abc")
    assert status == 2
    assert capsys.readouterr().err.count(caught.value.hint) == 1
