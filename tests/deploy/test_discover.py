"""kickctl discover, with real multicast DNS on loopback."""

import fcntl
import json
import os
import socket
import tempfile
import threading
from contextlib import contextmanager
from types import SimpleNamespace

import pytest
from zeroconf import DNSOutgoing, DNSPointer, IPVersion, ServiceInfo, Zeroconf
from zeroconf.const import _CLASS_IN, _FLAGS_AA, _FLAGS_QR_RESPONSE, _TYPE_PTR

from host.cli import main
from host.errors import NoLink, WrongUse
from host.link import discovery
from host.link.addresses import make_link
from host.link.discovery import BRICK, ROBOT, USER, look_around

LOOPBACK = ["127.0.0.1"]
# Questions go out at once, after 1 s and after 3 s, and a record that was sent within the last
# second is not sent again.
LONG_S = 4.0


@pytest.fixture(autouse=True)
def _network():
    """Have the network of this machine alone: each test hears what the others announce."""
    folder = os.open(tempfile.gettempdir(), os.O_RDONLY)
    fcntl.flock(folder, fcntl.LOCK_EX)
    yield
    os.close(folder)


@contextmanager
def announced(*services):
    """Services that answer on loopback.

    Each is (type, name, port, last number of the address or an address, properties).
    """
    with Zeroconf(interfaces=LOOPBACK) as network:
        for kind, name, port, number, properties in services:
            address = number if isinstance(number, str) else f"127.0.0.{number}"
            family = socket.AF_INET6 if ":" in address else socket.AF_INET
            addresses = [socket.inet_pton(family, address)]
            server = f"{name.replace(' ', '-')}.local."
            info = ServiceInfo(
                kind, f"{name}.{kind}", port, 0, 0, properties, server, addresses=addresses
            )
            network.register_service(
                info, cooperating_responders=True
            )  # nobody has to be asked whether the name is free
        yield


def test_robots_come_first_then_bricks_then_nothing_else():
    services = [
        (BRICK, "a plain brick", 22, 2, {USER: "robot"}),
        (BRICK, "file server", 22, 3, {}),
        (ROBOT, "runner", 5425, 4, {}),
        (ROBOT, "other port", 5426, 5, {}),
        (BRICK, "runner", 22, 4, {USER: "robot"}),
    ]
    with announced(*services):
        found = look_around(LONG_S, LOOPBACK)
    assert [(one.name, one.uri) for one in found] == [
        ("other port", "tcp://127.0.0.5:5426"),
        ("runner", "tcp://127.0.0.4"),
        ("a plain brick", "ssh://robot@127.0.0.2"),
    ]
    assert found[0].host == "other-port.local"


def record(kind, name, addresses=("127.0.0.6",), **properties):
    """A service's record as it came in, unlike one to send, unchecked."""
    values = {key.encode(): value.encode() for key, value in properties.items()}
    return SimpleNamespace(
        type=kind,
        name=f"{name}.{kind}",
        server="x.local.",
        port=1,
        properties=values,
        parsed_scoped_addresses=lambda version: list(addresses),
    )


def test_what_a_stranger_announces_is_printed_without_tricks():
    assert discovery._found(record(ROBOT, "evil\x1b[2J\x07")).name == "evil[2J"
    brick = discovery._found(record(BRICK, "b", **{USER: "-oProxyCommand=x y;z\n"}))
    assert brick.uri == "ssh://oProxyCommandxyz@127.0.0.6"
    assert discovery._found(record(BRICK, "b", **{USER: ""})) is None


@pytest.mark.parametrize("arguments", [(), ("--json",)])
def test_the_verb_prints_addresses_that_the_other_verbs_take(capsys, monkeypatch, arguments):
    monkeypatch.setattr(discovery.look_around, "__defaults__", (LOOPBACK,))
    with announced((ROBOT, "runner", 5425, 4, {})):
        assert main(["discover", "--seconds", str(LONG_S), *arguments]) == 0
    out = capsys.readouterr().out
    if arguments:
        (robot,) = json.loads(out)["robots"]
        assert (robot["uri"], robot["host"], robot["addresses"]) == (
            "tcp://127.0.0.4",
            "runner.local",
            ["127.0.0.4"],
        )
    else:
        assert out == "tcp://127.0.0.4  (runner: robot)\n"


def test_nobody_there_is_told_with_what_to_try(capsys, monkeypatch):
    monkeypatch.setattr(discovery.look_around, "__defaults__", (LOOPBACK,))
    assert main(["discover", "--seconds", "0.3", "--json"]) == 3
    captured = capsys.readouterr()
    answer = json.loads(captured.out)
    assert answer["robots"] == []
    assert answer["error"]["status"] == 3
    for advice in ("USB", "address", "ev3dev-2.local"):
        assert advice in captured.err


@pytest.mark.parametrize("seconds", [0.0, -1.0, float("nan"), float("inf")])
def test_no_time_to_listen(seconds):
    with pytest.raises(WrongUse):
        look_around(seconds, LOOPBACK)


@pytest.mark.parametrize(
    "error",
    [
        OSError(101, "Network is unreachable"),
        RuntimeError("No interfaces to listen on: Network is unreachable"),
    ],
)
def test_no_network_is_told_in_words(monkeypatch, error):
    def no_network(**options):
        raise error

    monkeypatch.setattr(discovery, "Zeroconf", no_network)
    with pytest.raises(NoLink, match="Network is unreachable"):
        look_around(0.1)


def test_a_machine_without_ipv6_listens_over_ipv4(monkeypatch):
    real = discovery.Zeroconf

    def old(interfaces, ip_version):
        if ip_version is not IPVersion.V4Only:
            raise OSError(97, "Address family not supported by protocol")
        return real(interfaces=interfaces, ip_version=ip_version)

    monkeypatch.setattr(discovery, "Zeroconf", old)
    assert look_around(0.1, LOOPBACK) == []


STRANGE = ("Gateway_00:1e:5e\n", "x" * 63 + "\x00", "a.b.c", "-", "\x7f")


def test_strange_names_and_ipv6_in_the_network_hide_nobody():
    """What zeroconf itself would refuse to announce comes straight from a socket."""
    packet = DNSOutgoing(_FLAGS_QR_RESPONSE | _FLAGS_AA)
    for name in STRANGE:
        for kind in (ROBOT, BRICK):
            packet.add_answer_at_time(
                DNSPointer(kind, _TYPE_PTR, _CLASS_IN, 120, f"{name}.{kind}"), 0
            )
    with (
        announced((ROBOT, "runner", 5425, 4, {}), (ROBOT, "six", 5425, "fd00::6", {})),
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender,
    ):
        loopback = socket.inet_aton(LOOPBACK[0])
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, loopback)
        heard = threading.Timer(
            0.5, lambda: [sender.sendto(data, ("224.0.0.251", 5353)) for data in packet.packets()]
        )
        heard.start()
        found = look_around(LONG_S, LOOPBACK)
        heard.join()
    assert [one.uri for one in found] == ["tcp://127.0.0.4", "tcp://[fd00::6]"]


def test_ipv6_addresses_can_be_typed():
    def uri(kind, *addresses):
        found = discovery._found(record(kind, "b", addresses, **{USER: "robot"}))
        if found is not None:
            make_link(found.uri)
        return found and found.uri

    name = socket.if_indextoname(1)
    assert uri(BRICK, "fe80::1%1") == f"ssh://robot@[fe80::1%{name}]"
    assert uri(ROBOT, "fe80::1%usb0") == "tcp://[fe80::1%usb0]:1"
    assert uri(ROBOT, "fe80::1%999999") == "tcp://[fe80::1%999999]:1"
    assert uri(ROBOT, "fe80::1%1", "fd00::2", "169.254.3.4") == "tcp://169.254.3.4:1"
    assert uri(ROBOT, "fe80::1%1", "fd00::2") == "tcp://[fd00::2]:1"
    assert uri(ROBOT, "fe80::1") is None
