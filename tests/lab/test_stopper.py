"""Who has stopped a robot, in the words of people."""

import pytest

from host.lab.stopper import of_this_lab, plain
from host.util.own_name import own_name


@pytest.mark.parametrize(
    ("reason", "words"),
    [
        ("'anna@lab-3' stopped it", "anna stopped it from the computer lab-3"),
        ("'no@body else@x' stopped it", "'no@body else@x' stopped it"),
        ("'Zoë' stopped it", "'Zoë' stopped it"),
        ("the brick's back button stopped it", "the brick's back button stopped it"),
    ],
)
def test_a_name_of_user_and_machine_is_a_person_at_a_computer(reason, words):
    assert plain(reason) == words


def test_the_lab_knows_its_own_name():
    assert of_this_lab(f"'{own_name()}' stopped it")
    assert not of_this_lab("'x@y' stopped it")
