"""What systemd is told, over a real datagram socket."""

import socket

import pytest

from robot.notify import Notify
from tests.rig import Rig


@pytest.fixture
def systemd(tmp_path):
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as link:
        link.bind(str(tmp_path / "notify"))
        link.setblocking(False)
        yield link


def said(link):
    """Everything that has arrived."""
    heard = []
    while True:
        try:
            heard.append(link.recv(100).decode("ascii"))
        except BlockingIOError:
            return heard


def test_ready_at_once_then_alive_twice_in_each_period_then_the_end(systemd):
    rig = Rig()
    notify = Notify({"NOTIFY_SOCKET": systemd.getsockname(), "WATCHDOG_USEC": "2000000"})
    assert said(systemd) == []
    notify.serve(rig.loop)
    assert said(systemd) == ["READY=1", "WATCHDOG=1"]
    for time, expected in (
        (0.5, []),
        (0.99, []),
        (1.0, ["WATCHDOG=1"]),
        (1.5, []),
        (9.0, ["WATCHDOG=1"]),
    ):
        rig.clock.time = time
        notify.serve(rig.loop)
        assert said(systemd) == expected, time
    notify.close()
    assert said(systemd) == ["STOPPING=1"]
    notify.close()


def test_without_a_watchdog_only_ready(systemd):
    rig = Rig()
    notify = Notify({"NOTIFY_SOCKET": systemd.getsockname()})
    for rig.clock.time in (0.0, 50.0):
        notify.serve(rig.loop)
    assert said(systemd) == ["READY=1"]
    notify.close()


def test_a_name_that_is_in_no_file_system():
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as link:
        link.bind("\0kickctl test")
        notify = Notify({"NOTIFY_SOCKET": "@kickctl test"})
        notify.serve(Rig().loop)
        assert link.recv(100) == b"READY=1"
        notify.close()


def test_a_systemd_that_is_gone_or_does_not_read_stops_nobody(systemd):
    rig = Rig()
    notify = Notify({"NOTIFY_SOCKET": systemd.getsockname(), "WATCHDOG_USEC": "2"})
    for second in range(1000):
        rig.clock.time = float(second)
        notify.serve(rig.loop)
    notify.close()
    absent = Notify({"NOTIFY_SOCKET": "/nowhere/notify", "WATCHDOG_USEC": "2000000"})
    absent.serve(rig.loop)
    absent.close()


def test_no_service_no_word():
    notify = Notify({})
    notify.serve(Rig().loop)
    notify.close()


@pytest.mark.parametrize("period", ["", "soon", "-1", "1e6"])
def test_a_period_that_is_no_number_is_none(systemd, period):
    notify = Notify({"NOTIFY_SOCKET": systemd.getsockname(), "WATCHDOG_USEC": period})
    notify.serve(Rig().loop)
    assert said(systemd) == ["READY=1"]
    notify.close()
