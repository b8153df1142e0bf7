"""Robots with names: the file that keeps them, and what a name on a command line means."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from host.errors import WrongUse
from host.link import robots_file
from host.link.addresses import place_of
from host.link.discovery import Found
from host.link.names import chosen, every, is_several, name_at, own_token, save, several
from host.link.robots_file import (
    Known,
    add,
    file_path,
    free_name,
    is_name,
    read,
    read_sound,
    remove,
    rename,
    token_path,
    update,
)

NAMES = st.from_regex("[A-Za-z0-9][A-Za-z0-9_-]{0,39}", fullmatch=True).filter(is_name)
TEXTS = st.text(st.characters(codec="utf-8"), min_size=1, max_size=20).filter(str.isprintable)
ROBOTS = st.dictionaries(
    NAMES, st.tuples(TEXTS, st.none() | TEXTS.map("/t/{}".format)), max_size=4
).filter(lambda robots: len({name.lower() for name in robots}) == len(robots))

BY_HAND = """\
# my robots
[anna] # the red one
# by cable
address = "tcp://10.0.0.1"

# bert has a dent
[bert]
address = "tcp://10.0.0.2"
token = "/keys/bert"
# the end
"""


@pytest.fixture
def by_hand():
    """A file that its owner wrote."""
    path = file_path()
    path.parent.mkdir(parents=True)
    path.write_text(BY_HAND, encoding="utf-8")
    return path


def write_token(name):
    path = token_path(name)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("00" * 32, encoding="ascii")
    return path


# The file


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(robots=ROBOTS, extra=NAMES)
def test_what_was_added_is_read_again_and_what_was_removed_is_gone(robots, extra):
    path = file_path()
    path.unlink(missing_ok=True)
    for name, (address, token) in robots.items():
        add(name, address, token)
    found = {one.name: (one.address, one.token) for one in read().values()}
    assert found == {
        name: (address, token and str(Path(token))) for name, (address, token) in robots.items()
    }
    assert list(found) == list(robots)
    if robots and extra.lower() not in map(str.lower, robots):
        first = next(iter(robots))
        rename(first, extra)
        renamed = [extra if name == first else name for name in robots]
        assert list(read()) == renamed
        for name in renamed:
            remove(name)
        assert read() == {}


def test_a_change_keeps_every_other_line(by_hand):
    add("carl", "serial:///dev/a")
    text = by_hand.read_text(encoding="utf-8")
    assert text == BY_HAND + '\n[carl]\naddress = "serial:///dev/a"\n'
    rename("anna", "zoe")
    assert by_hand.read_text(encoding="utf-8") == text.replace("[anna]", "[zoe]")
    remove("zoe")
    text = by_hand.read_text(encoding="utf-8")
    assert "# my robots\n" in text
    assert "# bert has a dent\n[bert]\n" in text
    assert "zoe" not in text
    assert "red one" not in text
    remove("bert")
    assert "# the end\n" in by_hand.read_text(encoding="utf-8")


def test_a_token_moves_and_goes_with_its_robot(by_hand):
    write_token("anna")
    assert read()["anna"].token == str(token_path("anna"))
    rename("anna", "zoe")
    assert read()["zoe"].token == str(token_path("zoe"))
    assert not token_path("anna").exists()
    write_token("anna")
    with pytest.raises(WrongUse, match="is there already"):
        rename("zoe", "anna")
    assert remove("zoe") == token_path("zoe")
    assert not token_path("zoe").exists()


def test_a_token_elsewhere_stays(by_hand, tmp_path):
    elsewhere = tmp_path / "key"
    elsewhere.write_text("x", encoding="ascii")
    add("carl", "tcp://h", str(elsewhere))
    rename("carl", "dora")
    assert read()["dora"].token == str(elsewhere)
    assert remove("dora") is None
    assert elsewhere.exists()


def test_a_token_is_named_relative_to_the_file(by_hand):
    by_hand.write_text('[a]\naddress = "tcp://h"\ntoken = "keys/a"\n', encoding="utf-8")
    assert read()["a"].token == str(by_hand.parent / "keys" / "a")


@pytest.mark.parametrize(
    ("text", "line", "why"),
    [
        ('[anna]\naddress = "tcp://h\n', 2, "Illegal"),
        ('[anna]\naddress = "a"\n[anna]\n', 3, ""),
        ('# x\n[anna]\ntoken = "t"\n', 2, "anna has no address"),
        ("[anna]\naddress = 3\n", 1, "the address of anna is no text"),
        ('[anna]\naddress = ""\n', 1, "the address of anna is no text"),
        ('[anna]\naddress = "a"\ntokn = "t"\n', 1, "unknown 'tokn'"),
        ('\naddress = "tcp://h"\n', 2, "outside of a robot's table"),
        ('[all]\naddress = "tcp://h"\n', 1, "'all' is no name"),
        ('["a b"]\naddress = "tcp://h"\n', 1, "'a b' is no name"),
    ],
)
def test_a_spoiled_file_is_named_with_its_line_and_nothing_changes(by_hand, text, line, why):
    by_hand.write_text(text, encoding="utf-8")
    for change in (read, lambda: add("x", "tcp://h"), lambda: rename("anna", "b"), every):
        with pytest.raises(WrongUse, match=re.escape(f"{by_hand}, line {line}")) as error:
            change()
        assert why in error.value.message
        assert "kickctl robots add" in error.value.hint
    assert by_hand.read_text(encoding="utf-8") == text
    assert chosen("tcp://h") == Known("tcp://h", "tcp://h")


@pytest.mark.parametrize(
    "wrong",
    [
        "[bert]\naddress = tcp://b\n",
        '[bert]\naddress = "tcp://b\n',
        '[bert]\naddress = "tcp://b"\ntokn = "t"\n',
        '[all]\naddress = "tcp://b"\n',
        '["b c"]\naddress = "tcp://b"\n',
        "[bert\n",
    ],
)
def test_a_robot_whose_own_lines_are_right_is_reached_all_the_same(by_hand, wrong):
    anna, carl = (f'[{name}]\naddress = "tcp://{name}"\n' for name in ("anna", "carl"))
    for text in (anna + wrong + carl, wrong + anna + carl, anna + carl + "\n" + wrong):
        by_hand.write_text(text, encoding="utf-8")
        assert {name: chosen(name).address for name in ("anna", "carl")} == {
            "anna": "tcp://anna",
            "carl": "tcp://carl",
        }
        with pytest.raises(WrongUse, match=re.escape(str(by_hand))) as error:
            chosen("bert")
        with pytest.raises(WrongUse) as of_file:
            read()
        assert str(error.value) == str(of_file.value)
        found, spoiled = read_sound()
        assert (list(found), str(spoiled)) == (["anna", "carl"], str(of_file.value))


def test_a_mark_at_the_beginning_as_of_windows_spoils_no_file(by_hand):
    by_hand.write_text('[anna]\naddress = "tcp://h"\n', encoding="utf-8-sig")
    assert list(read()) == ["anna"]


def test_a_file_that_is_no_text(by_hand):
    by_hand.write_bytes(b"\xff")
    with pytest.raises(WrongUse, match="no text"):
        read()
    assert read_sound()[0] == {}


@pytest.mark.parametrize("text", ['anna = {address = "a"}\n', 'anna.address = "a"\n'])
def test_a_form_that_lines_cannot_change_is_left_as_it_is(by_hand, text):
    by_hand.write_text(text, encoding="utf-8")
    for change in (
        lambda: rename("anna", "new"),
        lambda: remove("anna"),
        lambda: update("anna", address="tcp://h"),
    ):
        with pytest.raises(WrongUse, match="not change"):
            change()
        assert by_hand.read_text(encoding="utf-8") == text


@pytest.mark.parametrize(
    "name",
    ["", "all", "ALL", "sim", "ssh", "a b", "-a", "_a", "a.b", "tcp://h", "a,b", "ä", "a" * 41],
)
def test_what_no_robot_can_be_named(name, by_hand):
    with pytest.raises(WrongUse) as error:
        add(name, "tcp://h")
    assert "letters" in error.value.hint
    with pytest.raises(WrongUse):
        rename("anna", name)
    assert by_hand.read_text(encoding="utf-8") == BY_HAND


def test_a_name_stands_for_one_robot(by_hand):
    with pytest.raises(WrongUse, match=r"already, at tcp://10\.0\.0\.1"):
        add("anna", "tcp://h")
    with pytest.raises(WrongUse, match="'anna' already"):
        add("Anna", "tcp://h")  # nobody hears the difference
    assert free_name("BERT", ["anna", "bert"]) == "BERT-2"
    with pytest.raises(WrongUse, match="'bert' already"):
        rename("anna", "Bert")
    with pytest.raises(WrongUse, match="no robot 'ana'") as error:
        remove("ana")
    assert error.value.hint == "did you mean anna?"


def test_of_two_programs_that_add_at_once_none_loses_a_robot(tmp_path):
    """Each adds twenty robots, as fast as it can."""
    program = (
        "import sys; from host.link.robots_file import add\n"
        "for n in range(20): add(f'{sys.argv[1]}{n}', 'tcp://h')"
    )
    root = Path(robots_file.__file__).parents[2]
    programs = [
        subprocess.Popen([sys.executable, "-c", program, letter], cwd=root) for letter in "abc"
    ]
    assert [one.wait(60) for one in programs] == [0, 0, 0]
    assert len(read()) == 60


# What a person means


def test_the_robot_that_is_used(monkeypatch, by_hand):
    assert chosen(None) == Known("sim://", "sim://")
    assert chosen("anna") == Known("anna", "tcp://10.0.0.1")
    assert chosen("bert") == Known("bert", "tcp://10.0.0.2", "/keys/bert")
    monkeypatch.setenv("KICK_BRICK", "bert")
    assert (chosen(None).name, chosen("tcp://other").address) == ("bert", "tcp://other")
    with pytest.raises(WrongUse, match="is empty") as error:
        chosen("")
    assert error.value.hint
    monkeypatch.setenv("KICK_BRICK", "")
    assert chosen("tcp://other").address == "tcp://other"
    with pytest.raises(WrongUse, match="KICK_BRICK") as error:
        chosen(None)
    assert "unset KICK_BRICK" in error.value.hint


def test_an_unknown_name_is_answered_with_a_known_one(by_hand):
    with pytest.raises(WrongUse, match="no robot is named 'anan'") as error:
        chosen("anan")
    assert error.value.hint == "did you mean anna?"
    with pytest.raises(WrongUse) as error:
        chosen("xyz")
    assert "there are anna, bert" in error.value.hint
    by_hand.unlink()
    with pytest.raises(WrongUse) as error:
        chosen("xyz")
    assert "no robot has a name yet" in error.value.hint


def test_an_address_has_the_token_of_the_robot_there(by_hand):
    for address in ("tcp://10.0.0.2", "ssh://robot@10.0.0.2", "tcp://10.0.0.2:5425"):
        assert own_token(chosen(address)) == "/keys/bert"
    for address in ("tcp://10.0.0.1", "tcp://10.0.0.2:5426", "sim://"):
        assert own_token(chosen(address)) is None


@pytest.mark.usefixtures("by_hand")
def test_the_robot_at_an_address_is_known_by_its_name():
    places = ["tcp://10.0.0.1", "ssh://robot@10.0.0.2", "tcp://10.0.0.3", "sim://", "no address"]
    assert [name_at(place) for place in places] == ["anna", "bert", "", "", ""]
    file_path().write_text("spoiled", encoding="utf-8")
    assert name_at("tcp://10.0.0.1") == ""


def test_several_robots(by_hand):
    assert [one.name for one in several("bert, anna")] == ["bert", "anna"]
    assert [one.name for one in several("all")] == ["anna", "bert"]
    assert [one.name for one in several("anna,tcp://h")] == ["anna", "tcp://h"]
    for text, words in (
        ("anna,anan", "no robot is named 'anan'"),
        ("anna,,bert", "a name is missing"),
        ("anna,anna", "stands twice"),
        ("anna,all", "'all' stands for all robots with a name"),
    ):
        with pytest.raises(WrongUse, match=words):
            several(text)
    with pytest.raises(WrongUse, match="means several robots"):
        chosen("anna,bert")
    assert [one.name for one in several("sim://,anna")] == ["sim://", "anna"]
    assert is_several("sim://,anna")
    assert not is_several("sim://?motor=a,b")
    by_hand.unlink()
    with pytest.raises(WrongUse, match="no robot has a name"):
        several("all")


# Robots that have moved


def found(name, address, host="", hardware_id=None, more=()):
    place = place_of(address)[0]
    return Found(name, "robot", address, host, (place, *more), hardware_id)


def test_robots_that_have_swapped_their_addresses_keep_their_names():
    add("anna", "tcp://10.0.0.1", None, "a")
    add("bert", "ssh://robot@10.0.0.2:2222?host=10.0.0.2&port=5425", None, "b")
    saved = save(
        [found("x", "tcp://10.0.0.1", "", "b"), found("y", "tcp://[fd00::2]", "", "a")],
    )
    assert (saved.named, list(saved.moved)) == ({}, ["bert", "anna"])
    assert {one.name: one.address for one in read().values()} == {
        "anna": "tcp://[fd00::2]",
        "bert": "ssh://robot@10.0.0.1:2222?host=10.0.0.1&port=5425",
    }


@pytest.mark.parametrize(
    ("known", "host", "now"),
    [
        ("tcp://10.0.0.1", "ev3dev.local", "tcp://10.0.0.9"),
        ("ssh://robot@ev3dev.local", "ev3dev.local", "ssh://robot@ev3dev.local"),
        ("ssh://robot@ev3dev.local", "ev3dev-2.local", "ssh://robot@ev3dev-2.local"),
        ("tcp://10.0.0.10", "ev3dev.local", "tcp://10.0.0.10"),  # its other address
        ("ssh://my-brick", "ev3dev.local", "ssh://my-brick"),  # a name of ~/.ssh/config
        ("tcp://robot.school.example", "ev3dev.local", "tcp://robot.school.example"),
        ("tcp://127.0.0.1", "ev3dev.local", "tcp://127.0.0.1"),
    ],
)
def test_only_an_address_that_leads_nowhere_is_changed(known, host, now):
    add("anna", known, None, "a")
    saved = save([found("ev3dev", "tcp://10.0.0.9", host, "a", ("10.0.0.10",))])
    assert saved.named == {}
    assert read()["anna"].address == now
    assert saved.moved == ({} if now == known else {"anna": (known, now)})


def test_another_machine_at_a_known_address_is_another_robot():
    add("anna", "tcp://10.0.0.1", None, "a")
    assert save([found("new", "tcp://10.0.0.1", "", "b")]).named == {"new": "tcp://10.0.0.1"}
    assert read()["anna"] == Known("anna", "tcp://10.0.0.1", None, "a")


def test_an_id_that_two_machines_have_tells_nothing():
    add("anna", "tcp://10.0.0.1", None, "a")
    copies = [found("x", f"tcp://10.0.0.{number}", "", "a") for number in (1, 2)]
    saved = save(copies)
    assert (saved.named, saved.moved) == ({"x": "tcp://10.0.0.2"}, {})
    assert read()["x"].hardware_id is None
    both = [found("x", f"tcp://10.0.0.3:{port}", "", "c") for port in (1, 2)]
    assert [read()[name].hardware_id for name in save(both).named] == ["c", "c"]


def test_a_changed_value_leaves_all_else_in_its_line(by_hand):
    by_hand.write_text('[anna]\naddress="tcp://h" # mine\ntoken = "t"', encoding="utf-8")
    update("anna", address="tcp://new", hardware_id="a")
    text = '[anna]\naddress="tcp://new" # mine\ntoken = "t"\nhardware_id = "a"\n'
    assert by_hand.read_text(encoding="utf-8") == text
    with pytest.raises(WrongUse, match="no robot 'ana'"):
        update("ana", address="tcp://h")


def test_addresses_may_be_listed_as_names_are():
    both = "tcp://10.0.0.1:5425, ssh://robot@bert"
    assert is_several(both)
    assert [one.address for one in several(both)] == both.split(", ")
    assert not is_several("serial:///dev/a,b")
