"""A serial line's argument and its opening: wrong ones are refused, broken ones come back."""

import fcntl
import os
import pty
import sys
import termios
import tty

import pytest

from robot.errors import Refused
from robot.serial_line import SerialLine, parse


@pytest.fixture
def line():
    """The two ends of a line: a descriptor, and the name of the device at the other end."""
    far, near = pty.openpty()
    tty.setraw(far)
    name = os.ttyname(near)
    os.close(near)
    yield far, name
    os.close(far)


def quiet(text):
    raise AssertionError(text)


@pytest.mark.parametrize(
    ("argument", "parts"),
    [
        ("/dev/ttyS1", ("/dev/ttyS1", 115200)),
        ("/dev/ttyS1@9600", ("/dev/ttyS1", 9600)),
        ("/dev/tty@home@9600", ("/dev/tty@home", 9600)),
    ],
)
def test_what_names_a_line(argument, parts):
    assert parse(argument) == parts


@pytest.mark.parametrize(
    "argument",
    ["", "@", "@9600", "DEV@", "DEV@fast", "DEV@-1", "DEV@0", "DEV@99999999999", "DEV@4000001"]
    + ["DEV@\u00b2", "DEV@9_6", "DEV@ 9600", "DEV@9600.0"],
)
def test_what_names_no_line_is_refused_with_an_example(argument):
    with pytest.raises(Refused) as caught:
        parse(argument)
    assert "/dev/ttyUSB0@115200" in caught.value.hint


@pytest.mark.parametrize(
    ("device", "words", "hint"),
    [
        ("/dev/nosuch", "No such file", "cable"),
        ("/dev/null", "not a serial line", "name a serial line"),
        ("/", "not a serial line", "name a serial line"),
        ("/dev/null\0", "not a serial line", "name a serial line"),
    ],
)
def test_a_line_that_cannot_be_opened_is_refused_in_words(device, words, hint):
    with pytest.raises(Refused, match=words) as caught:
        SerialLine(device, quiet)
    assert hint in caught.value.hint


def test_without_pyserial_it_is_refused_with_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "serial", None)
    with pytest.raises(Refused, match="needs pyserial") as caught:
        SerialLine("/dev/null", quiet)
    assert "python3-serial" in caught.value.hint


@pytest.mark.parametrize("error", [ValueError("no such rate"), termios.error(22, "Invalid")])
def test_what_pyserial_says_of_a_line_that_it_cannot_set_up(monkeypatch, line, error):
    import serial

    def fail(*arguments, **options):
        raise error

    monkeypatch.setattr(serial, "Serial", fail)
    with pytest.raises(Refused, match="cannot be opened: it is not a serial line, or does not"):
        SerialLine(line[1], quiet)


def test_a_line_that_another_program_has_is_refused(line):
    other = os.open(line[1], os.O_RDWR | os.O_NOCTTY)
    fcntl.flock(other, fcntl.LOCK_EX)
    with pytest.raises(Refused, match="another program has it open") as caught:
        SerialLine(line[1], quiet)
    assert "fuser -v " + line[1] in caught.value.hint
    os.close(other)
    SerialLine(line[1], quiet).open().close()


def test_nobody_else_gets_the_line(line):
    mine = SerialLine(line[1], quiet)
    with pytest.raises(Refused, match="another program has it open"):
        SerialLine(line[1], quiet)
    mine.open().close()


def test_a_line_that_breaks_is_told_once_and_again_when_it_is_back(line):
    said = []
    opener = SerialLine(line[1], said.append)
    first = opener.open()
    first.close()
    good, opener._device = opener._device, "/dev/nosuch"
    for _ in range(3):
        with pytest.raises(OSError, match="No such file"):
            opener.open()
    assert len(said) == 1
    assert "/dev/nosuch broke: No such file" in said[0]
    opener._device = good
    opener.open().close()
    assert "opened again" in said[1]
    assert len(said) == 2
