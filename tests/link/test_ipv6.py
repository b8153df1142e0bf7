"""A robot over IPv6: from an address as a person types it to the robot's port."""

import socket
from pathlib import Path

import pytest

from host.client.robot import Robot
from host.errors import NoLink
from host.link.addresses import make_link
from robot.loop import Loop
from robot.motors import MonotonicClock
from robot.server import Server
from tests.link.machines import TcpRobot
from tests.rig import TOKEN, Motor

INTERFACES = Path("/proc/net/if_inet6")
if not INTERFACES.exists():
    pytest.skip("this machine has no IPv6", allow_module_level=True)


def link_local():
    """Link-local addresses of this machine, each with its interface."""
    for line in INTERFACES.read_text(encoding="ascii").splitlines():
        number, _, _, _, _, interface = line.split()
        address = socket.inet_ntop(socket.AF_INET6, bytes.fromhex(number))
        if address.startswith("fe80"):
            yield f"{address}%{interface}"
            yield f"{address}%25{interface}"


@pytest.fixture
def machine():
    machine = TcpRobot(host="::")
    yield machine
    machine.close()


def test_a_robot_that_listens_everywhere_is_reached_by_both(machine):
    for host in ("[::1]", "127.0.0.1", *(f"[{address}]" for address in link_local())):
        with Robot(make_link(f"tcp://{host}:{machine.port}"), TOKEN) as robot:
            assert robot.status()["state"] == "running"
            assert robot.stop_at_once().state == "stopped"
            robot.start()


def test_one_address_of_ipv6_is_that_address_alone():
    server = Server(Loop((Motor(), Motor()), None, MonotonicClock(), 1), TOKEN)
    port = server.listen("::1", 0)
    try:
        with pytest.raises(NoLink, match="no robot"):
            make_link(f"tcp://127.0.0.1:{port}").open()
    finally:
        server.close()


def test_an_interface_that_is_not_there_is_told_in_words():
    with pytest.raises(NoLink, match="no robot answers"):
        make_link("tcp://[fe80::1%nosuch0]").open()
