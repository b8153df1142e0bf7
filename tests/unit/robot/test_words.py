"""Names and times in words, and lines of them."""

import pytest

from robot.words import duration, person, say


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (-0.1, "0 s"),
        (0.0, "0 s"),
        (59.99, "59 s"),
        (60.0, "1 min 0 s"),
        (130.2, "2 min 10 s"),
        (3599.9, "59 min 59 s"),
        (3600.0, "1 h 0 min"),
        (90061.0, "25 h 1 min"),
    ],
)
def test_a_duration_has_its_two_largest_units(seconds, words):
    assert duration(seconds) == words


def test_a_name_is_quoted_and_somebody_may_have_none():
    assert person("anna@lab-1") == "'anna@lab-1'"
    assert [person(name) for name in ("", "  ")] == ["somebody without a name"] * 2


def test_a_line_is_printed_if_it_can_be():
    class Latin:
        encoding = "ascii"

        def __init__(self):
            self.text = ""

        def write(self, text):
            self.text += text.encode("ascii").decode("ascii")

        def flush(self):
            raise OSError(28, "No space left on device")

    stream = Latin()
    say("stopped by Zo\u00eb", stream)
    assert stream.text == "stopped by Zo\\xeb\n"
    say("nobody hears it", None)
