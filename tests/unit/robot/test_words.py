"""Names and times in words, and lines of them."""

import io
import os
import termios
import threading

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
    class Latin(io.TextIOBase):
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


def test_a_terminal_that_is_stopped_holds_nothing_up():
    """^S is typed there, and a robot says something: its loop must go on."""
    mine, terminal = os.openpty()
    with os.fdopen(terminal, "w") as stream:
        termios.tcflow(terminal, termios.TCOOFF)
        thread = threading.Thread(target=say, args=("lost", stream), daemon=True)
        thread.start()
        thread.join(10.0)
        held_up = thread.is_alive()
        termios.tcflow(terminal, termios.TCOON)
        thread.join(10.0)
        say("heard", stream)
        assert not held_up
        assert os.read(mine, 100) == b"heard\r\n"
    os.close(mine)
