"""How pages speak of this computer, and say why a robot has stopped."""

import pytest

from host.lab.page_words import for_page, reason
from host.util.own_name import own_name
from robot.words import person


@pytest.mark.parametrize(
    ("words", "plain"),
    [
        ("the link broke ([Errno 104] Connection reset)", "the link broke (Connection reset)"),
        ("copy /root/.config/kickctl/tokens/anna here", "copy anna here"),
        ("tcp://anna.local:8472/a/b is silent", "tcp://anna.local:8472/a/b is silent"),
        ("is /dev/ttyUSB0 there?", "is /dev/ttyUSB0 there?"),
        ("the folder logs/a is full", "the folder logs/a is full"),
    ],
)
def test_a_page_hears_no_path_of_this_disk_and_no_number_of_its_system(words, plain):
    assert for_page(words) == plain


def test_a_lab_that_was_silent_is_no_person_at_a_computer():
    said = reason(f"{person(own_name())} was silent for 0.5 s")
    assert said == "this lab was silent for 0.5 s, so the robot stopped by itself"
    assert reason("'x@y' stopped it") == "x stopped it from the computer y"
