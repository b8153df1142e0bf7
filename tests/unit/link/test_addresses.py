"""Addresses of robots: what is one, and that anything else is refused in words."""

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from host.errors import KickctlError, NoLink, WrongUse
from host.link.addresses import make_link, place_of, sim_options, with_params
from host.link.serial_line import SerialLink
from host.link.transport import TcpLink
from robot.wire import BAUD, PORT


@pytest.mark.parametrize(
    ("uri", "address"),
    [
        ("tcp://ev3dev.local", ("ev3dev.local", PORT)),
        ("tcp://EV3-Lab:5426", ("EV3-Lab", 5426)),
        ("tcp://brick_2.", ("brick_2.", PORT)),
        ("tcp://127.0.0.1:", ("127.0.0.1", PORT)),
        ("tcp://127.0.0.1/", ("127.0.0.1", PORT)),
        ("TCP://bücher.local", ("bücher.local", PORT)),
        ("tcp://[::1]:5426", ("::1", 5426)),
        ("tcp://[fe80::216:53ff:fe00:1%usb0]", ("fe80::216:53ff:fe00:1%usb0", PORT)),
        ("tcp://[fe80::1%25usb0]:1", ("fe80::1%usb0", 1)),
        ("tcp://[FE80::1%25enx0Ab]", ("fe80::1%enx0Ab", PORT)),
        ("tcp://[fe80::1%25]", ("fe80::1%25", PORT)),
        ("tcp://[fe80::1%2525net]", ("fe80::1%25net", PORT)),
    ],
)
def test_tcp_addresses(uri, address):
    link = make_link(uri)
    assert isinstance(link, TcpLink)
    assert (link.uri, link._address) == (uri, address)


@pytest.mark.parametrize(
    ("uri", "device", "baud"),
    [
        ("serial:///dev/ttyUSB0", "/dev/ttyUSB0", BAUD),
        ("serial:///dev/ttyUSB0?baud=9600", "/dev/ttyUSB0", 9600),
        ("serial:///dev/a line", "/dev/a line", BAUD),
    ],
)
def test_serial_addresses(uri, device, baud):
    link = make_link(uri)
    assert isinstance(link, SerialLink)
    assert (link.device, link._serial.baudrate) == (device, baud)


@pytest.mark.parametrize(
    ("uri", "why"),
    [
        ("tcp://ev3dev..local", "no machine's name"),
        ("tcp://" + "a" * 64, "no machine's name"),
        ("tcp://h:0", "ports are 1 to 65535"),
        ("tcp://h:65536", "ports are 1 to 65535"),
        ("tcp://h:" + "9" * 5000, "ports are 1 to 65535"),
        ("tcp://h:²", "ports are 1 to 65535"),
        ("tcp://h:-1", "ports are 1 to 65535"),
        ("tcp://[::1]:-1", "ports are 1 to 65535"),
        ("tcp://", "no machine's name"),
        ("tcp://:5425", "no machine's name"),
        ("tcp:h", "begins with none of"),
        ("tcp://fe80::1", "stands in brackets"),
        ("tcp://[fe80::1%]", "."),
        ("tcp://[fe80::1%usb 0]", "no network interface"),
        ("tcp://[fe80::1%a/b]", "."),
        ("tcp://[fe80::1]", "needs the interface"),
        ("tcp://[127.0.0.1]", "."),
        ("tcp://[::1]x:5", "."),
        ("tcp://x[::1]", "."),
        ("tcp://robot@h", "only a host and a port"),
        ("tcp://h/x", "only a host and a port"),
        ("tcp://h?port=1", "no option 'port'"),
        ("tcp://h?baudrate=1", "no option 'baudrate'"),
        ("tcp://h#x", "#"),
        ("tcp://h\n", "cannot be printed"),
        ("tcp://\udcff", "cannot be printed"),
        ("serial://dev/ttyUSB0", "names no device file"),
        ("serial://", "names no device file"),
        ("serial:/dev/ttyUSB0", "begins with none of"),
        ("serial:///dev/ttyUSB0?baud=²", "no baud rate"),
        ("serial:///dev/ttyUSB0?baud=0", "no baud rate"),
        ("serial:///dev/ttyUSB0?baud=99999999999999999999", "no baud rate"),
        ("serial:///dev/ttyUSB0?baud=", "no baud rate"),
        ("serial:///dev/ttyUSB0?baudrate=9600", "no option 'baudrate'; the only option is baud"),
        ("serial:///dev/ttyUSB0?baud=9600&parity=E", "no option 'parity'"),
        ("serial:///dev/ttyUSB0?baud=9600&baud=4800", "'baud' stands in it twice"),
        ("serial:///dev/tty\0", "cannot be printed"),
        ("sim://robot", "has no name"),
        ("sim:///x", "has no name"),
        ("sim:", "begins with none of"),
        ("http://h", "begins with none of sim"),
        ("ev3dev.local", "begins with none of"),
        ("", "begins with none of"),
        ("tcp://[", "."),
        ("tcp://℀", "."),
    ],
)
def test_what_is_no_address_is_refused_with_why_and_what_to_write(uri, why):
    with pytest.raises(WrongUse, match=why) as error:
        make_link(uri)
    assert error.value.hint
    assert error.value.message.isprintable()


@pytest.mark.parametrize(
    ("uri", "words"),
    [
        ("sim://?k=2&k=3", "'k' stands in it twice"),
        ("sim://?seed=1&k=2&seed=1", "'seed' stands in it twice"),
        ("ssh://h?port=1&port=2", "'port' stands in it twice"),
        ("tcp://h?port=1&port=2", "'port' stands in it twice"),
        ("ssh://h?baud=1", "no option 'baud'"),
        ("ssh://h?port=no", "port cannot be 'no'"),
        ("ssh://h?host=a b", "'a b' is no machine's name"),
        ("sim://?nosuch=1", "no option 'nosuch'"),
        ("sim://?seed=1e3", "seed cannot be '1e3'"),
        ("sim://?seed=1_0", "seed cannot be '1_0'"),
        ("sim://?seed=-1", "seed cannot be '-1'"),
        ("sim://?seed=", "seed cannot be ''"),
        ("sim://?seed=" + "9" * 41, "seed cannot be 9"),
        ("sim://?battery=full", "battery cannot be 'full'"),
        ("sim://?walls=2,5", "walls cannot be '2,5'"),
        ("sim://?walls=2&grip=x", "grip cannot be 'x'"),
        ("sim://?idle=no", "idle cannot be 'no'"),
        ("sim://?k=1_0", "k cannot be '1_0'"),
        ("sim://?motor=nosuch", "no motor 'nosuch'"),
    ],
)
def test_options_are_refused_in_plain_words(uri, words):
    with pytest.raises(WrongUse, match=words) as error:
        make_link(uri)
    assert error.value.hint
    for raw in ("literal", "base 10", "convert", "float", "expected"):
        assert raw not in error.value.message


@pytest.mark.parametrize(
    ("uri", "shown"),
    [
        ("tcp://h\x1b[2J", r"'tcp://h\\x1b\[2J'"),
        ("tcp://h\n", r"'tcp://h\\n'"),
        ("tcp://\udcff", r"'tcp://\\udcff'"),
        ("sim://?k%0a=1", r"'k\\n'"),
        ("sim://?motor=%1b", r"'\\x1b'"),
        ("ssh://h\0", r"'ssh://h\\x00'"),
    ],
)
def test_letters_that_cannot_be_printed_are_shown_as_codes(uri, shown):
    with pytest.raises(WrongUse, match=shown) as error:
        make_link(uri)
    assert error.value.message.isprintable()


def test_a_parameter_is_set_once():
    with pytest.raises(WrongUse, match="--set gives k twice"):
        with_params("sim://", ["k=1", "tau_s=1", "k=2"])


@pytest.mark.parametrize(
    ("path", "words"),
    [
        (".", "is a folder"),
        ("file", "is a file and no device"),
        ("nosuch", "No such file"),
        ("/dev/null", "does not behave as a serial line"),
    ],
)
def test_what_is_no_serial_line_is_named(tmp_path, path, words):
    (tmp_path / "file").touch()
    with pytest.raises(NoLink, match=words) as error:
        make_link(f"serial://{tmp_path / path}").open()
    assert ("cable" in error.value.hint) == (path in ("nosuch", "/dev/null"))


def test_only_the_embedded_robot_takes_a_seed_and_parameters():
    with pytest.raises(WrongUse, match="seed"):
        make_link("tcp://h", seed=1)
    with pytest.raises(WrongUse, match="embedded"):
        with_params("tcp://h", ["k=1"])
    assert sim_options(with_params("sim://?seed=1", ["k=2.5"])) == {"seed": "1", "k": "2.5"}


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("127.0.0.1:5531", "tcp://127.0.0.1:5531"),
        ("ev3dev.local", "tcp://ev3dev.local"),
        ("[::1]:5531", "tcp://[::1]:5531"),
        ("robot@ev3dev.local", "ssh://robot@ev3dev.local"),
        ("/dev/ttyUSB0", "serial:///dev/ttyUSB0"),
        ("serial:/dev/ttyUSB0", "serial:///dev/ttyUSB0"),
        ("tcp:ev3dev.local", "tcp://ev3dev.local"),
        ("tpc://ev3dev.local:1", "tcp://ev3dev.local:1"),
        ("shh://robot@h", "ssh://robot@h"),
        ("sim", "sim://"),
    ],
)
def test_what_was_probably_meant(text, meant):
    with pytest.raises(WrongUse) as error:
        make_link(text)
    assert error.value.hint == f"did you mean {meant}?"


@pytest.mark.parametrize("text", ["http://h", "", "::", "a b.c", "tcp:", "@", ":"])
def test_nothing_is_proposed_that_would_be_refused(text):
    with pytest.raises(WrongUse) as error:
        make_link(text)
    assert "addresses are sim://" in error.value.hint


def test_the_place_of_a_robot():
    assert place_of("tcp://Ev3") == place_of("ssh://robot@ev3:2222") == ("ev3", str(PORT))
    assert place_of("tcp://ev3:7") == place_of("ssh://ev3?port=7")
    assert place_of("tcp://[::1]:7") == ("::1", "7")
    assert place_of("serial:///dev/a?baud=9600") == place_of("serial:///dev/a")
    assert place_of("serial:///dev/a") != place_of("serial:///dev/b")


PIECES = st.sampled_from(
    (
        *("tcp", "ssh", "sim", "serial", "://", ":", "/", "?", "#", "@", "[", "]", "%", "%25", "&"),
        *("=", "..", ".", "-", " ", "~", "\\", "\n", "\0", "\udc80", "²", "℀", "é", "ffff", "::1"),
        *("fe80::1", "usb0", "0", "1", "65536", "9" * 30, "1e999", "nan", "inf", "-1", "127.0.0.1"),
        *("localhost", "dev", "ttyUSB0", "port", "baud", "seed", "motor", "battery", "walls"),
        *("grip", "idle", "k", "tau_s", "tick_s", "pybricks", "robot", "x" * 70, "xn--", "xn--a"),
    )
)
URIS = st.lists(PIECES | st.text(max_size=3), max_size=12).map("".join)
WITH_SCHEME = st.builds(
    "{}://{}".format, st.sampled_from(("tcp", "ssh", "sim", "serial")), URIS
) | st.builds(
    "{}?{}={}".format,
    st.sampled_from(("sim://", "tcp://h", "ssh://h", "serial:///dev/x")),
    PIECES,
    URIS,
)


@settings(max_examples=400)
@given(URIS | WITH_SCHEME)
@example("sim://?walls=1e308")
@example("sim://?walls=nan")
@example("sim://?seed=-1")
@example("ssh://h:99999")
@example("ssh://h?port=²")
def test_every_text_is_an_address_or_is_refused_in_words(uri):
    for use in (make_link, sim_options, lambda given: with_params(given, ["k=1"])):
        try:
            use(uri)
        except KickctlError as error:
            assert error.status == 2
            assert error.message
