"""An address of a brick means the same to deploy.sh, to kickctl deploy and to ssh://."""

import subprocess

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from host.errors import WrongUse
from host.link.addresses import make_link
from host.link.logins import Login, parse_login
from tests.deploy.brick import ROOT

# (an address, what it means, how it is printed)
TABLE = [
    ("robot@ev3dev.local", Login("robot", "ev3dev.local", None), "robot@ev3dev.local"),
    ("EV3-Lab", Login("", "EV3-Lab", None), "EV3-Lab"),
    ("Robot@EV3_Lab.2", Login("Robot", "EV3_Lab.2", None), "Robot@EV3_Lab.2"),
    ("ssh://u@h:22", Login("u", "h", 22), "u@h:22"),
    ("ssh://u@h:2222/", Login("u", "h", 2222), "u@h:2222"),
    ("ssh://EV3-Lab", Login("", "EV3-Lab", None), "EV3-Lab"),
    ("h:65535", Login("", "h", 65535), "h:65535"),
    ("root@::1", Login("root", "::1", None), "root@[::1]"),
    ("::", Login("", "::", None), "[::]"),
    ("[::1]", Login("", "::1", None), "[::1]"),
    ("ssh://root@[::1]:22", Login("root", "::1", 22), "root@[::1]:22"),
    ("robot@fe80::1%usb0", Login("robot", "fe80::1%usb0", None), "robot@[fe80::1%usb0]"),
    ("ssh://[fe80::1%25usb0]:22", Login("", "fe80::1%usb0", 22), "[fe80::1%usb0]:22"),
    ("fe80::1%25", Login("", "fe80::1%25", None), "[fe80::1%25]"),
    ("::ffff:192.168.0.1", Login("", "::ffff:192.168.0.1", None), "[::ffff:192.168.0.1]"),
    ("192.168.0.1", Login("", "192.168.0.1", None), "192.168.0.1"),
]
NONE = [
    "ssh://",
    "@h",
    "u@",
    "u@@h",
    "a@b@c",
    "u:secret@h",
    "-oProxyCommand=x",
    "u@-h",
    "-u@h",
    "h:",
    "h:0",
    "h:022",
    "h:65536",
    "h:x",
    "h:\u00b2",
    "h/",
    "ssh://h/home",
    "ssh://h?port=1",
    "ssh://ssh://h",
    "tcp://h",
    "SSH://h",
    "serial:///dev/ttyUSB0",
    "[::1",
    "[h]",
    "[::1]22",
    "::1]:22",
    "fe80::1%",
    "fe80::1%a/b",
    "g::1",
    "a b",
    "a;b",
    "$(b)",
    "h\nh",
    "h\n",
    "h'",
    "k\u00fcche",
    " h",
]


def in_shell(text):
    """How deploy.sh prints an address; None if it refuses it."""
    done = subprocess.run(
        [ROOT / "deploy.sh", "--dry-run", "--status", text],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode == 2:
        assert done.stderr.startswith("deploy: ")
        return None
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout.removeprefix("would connect to ").removesuffix(" and show its status\n")


def in_python(text):
    """How kickctl prints an address; None if it refuses it."""
    try:
        return str(parse_login(text))
    except WrongUse:
        return None


@pytest.mark.parametrize(("text", "login", "printed"), TABLE)
def test_what_an_address_means(text, login, printed):
    assert parse_login(text) == login
    assert str(login) == printed
    assert parse_login(printed) == login
    assert in_shell(text) == printed
    assert make_link(f"ssh://{printed}")._login == login


@pytest.mark.parametrize("text", NONE)
def test_what_is_no_address(text):
    assert in_python(text) is None
    assert in_shell(text) is None


@settings(max_examples=60)
@given(st.text(st.sampled_from("aZ0.:@[]%-/_2 5\n"), min_size=1, max_size=12))
def test_shell_and_python_agree_about_every_text(text):
    if not text.startswith("-"):  # an option of deploy.sh
        assert in_shell(text) == in_python(text)


@given(st.text(max_size=40))
def test_every_text_is_an_address_or_refused_in_words(text):
    for scheme in ("", "ssh://"):
        try:
            login = parse_login(scheme + text)
        except WrongUse:
            continue
        assert parse_login(str(login)) == login
        make_link(f"ssh://{login}")


@pytest.mark.parametrize(
    "query", ["port=x", "port=0", "port=65536", "prot=1", "port=1&port=2", "host=a/b", "host="]
)
def test_options_that_ssh_addresses_do_not_have(query):
    with pytest.raises(WrongUse, match="no address of a robot"):
        make_link("ssh://brick?" + query)


def test_where_the_robot_listens_goes_into_the_tunnel():
    link = make_link("ssh://brick?host=fe80::2%25usb0&port=77")
    assert "[fe80::2%usb0]:77" in link._options
    assert "127.0.0.1:5425" in make_link("ssh://brick")._options


def test_an_open_quote_in_the_options_is_refused_by_both(monkeypatch):
    monkeypatch.setenv("KICK_SSH_OPTIONS", "-i 'my key")
    with pytest.raises(WrongUse, match="KICK_SSH_OPTIONS"):
        make_link("ssh://brick")
    assert in_shell("brick") is None
