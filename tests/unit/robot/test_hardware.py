"""A machine's lasting id: its own number, from the best place, and never as it is."""

import re

import pytest

from robot import hardware
from robot.hardware import hardware_id

UEVENT = (
    "BOARD_INFO_HW_REV=7\nBOARD_INFO_MODEL=LEGO MINDSTORMS EV3\nBOARD_INFO_SERIAL_NUM={}\n"
    "BOARD_INFO_TYPE=main\n"
)


@pytest.fixture
def machine(tmp_path, monkeypatch):
    """A function that writes a machine's files: (of the EV3's board, of another board, system)."""

    def write(brick=None, board=None, system=None):
        places = (("boards/board0/uevent", brick), ("serial-number", board), ("machine-id", system))
        for name, text in places:
            if (tmp_path / name).exists():
                (tmp_path / name).unlink()
            if text is not None:
                (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
                (tmp_path / name).write_text(text)

    monkeypatch.setattr(hardware, "_BRICK", str(tmp_path / "boards"))
    monkeypatch.setattr(hardware, "_BOARD", str(tmp_path / "serial-number"))
    monkeypatch.setattr(hardware, "_SYSTEM", str(tmp_path / "machine-id"))
    return write


def test_a_serial_number_counts_more_than_what_a_copied_card_brings(machine):
    found = []
    for parts in (
        {"system": "0123456789abcdef0123456789abcdef\n"},
        {"system": "0123456789abcdef0123456789abcdef\n", "board": "10000000abcd1234\0"},
        {"system": "another", "board": "10000000abcd1234\0"},
        {"system": "another", "brick": UEVENT.format("00165340e49b")},
        {"system": "other", "board": "other", "brick": UEVENT.format("00165340e49b")},
        {"system": "other", "board": "other", "brick": UEVENT.format("00165340e49c")},
    ):
        machine(**parts)
        found.append(hardware_id())
    assert [found.index(one) for one in found] == [0, 1, 1, 3, 3, 5]
    assert all(re.fullmatch("[0-9a-f]{32}", one) for one in found)


@pytest.mark.parametrize(
    "parts",
    [
        {},
        {"system": ""},
        {"system": "uninitialized\n"},
        {"system": "0" * 32, "brick": UEVENT.format("000000000000"), "board": "0000\0"},
        {"brick": "BOARD_INFO_MODEL=FAKE-SYS\n"},
    ],
)
def test_a_machine_without_a_number_has_no_id(machine, parts):
    machine(**parts)
    assert hardware_id() == ""


def test_the_number_itself_is_not_told(machine):
    number = "0123456789abcdef0123456789abcdef"
    machine(system=number + "\n")
    told = hardware_id()
    assert told != number
    assert number[:8] not in told
