"""kickctl discover over a cable that has IPv6 addresses of its own only, as a USB cable has.

Two network namespaces of Linux stand for the two machines, and a pair of virtual interfaces for the
cable.
"""

import json
import os
import shutil
import subprocess
import sys
from contextlib import contextmanager

import pytest

from robot.program import PORT
from tests.lint.sources import ROOT

PATIENCE_S = 60.0
LISTEN_S = "4"
# What avahi does on a brick whose program is a service.
ANNOUNCE = """
import socket, sys
from zeroconf import IPVersion, ServiceInfo, Zeroconf
kind = "_kickctl._tcp.local."
address = socket.inet_pton(socket.AF_INET6, "fe80::b")
info = ServiceInfo(kind, "runner." + kind, {port}, server="runner.local.", addresses=[address])
with Zeroconf(ip_version=IPVersion.V6Only) as network:
    network.register_service(info, cooperating_responders=True)
    print("READY", flush=True)
    sys.stdin.read()
""".replace("{port}", str(PORT))
_LAPTOP, _BRICK = f"kick{os.getpid()}l", f"kick{os.getpid()}b"


def ip(*words, check=True):
    return subprocess.run(["ip", *words], check=check, capture_output=True, timeout=PATIENCE_S)


def _allowed():
    """Whether this user may make network namespaces here."""
    if shutil.which("ip") is None or ip("netns", "add", _LAPTOP, check=False).returncode:
        return False
    return not ip("netns", "delete", _LAPTOP, check=False).returncode


pytestmark = pytest.mark.skipif(
    not _allowed(), reason="only root may make network namespaces, by the program ip"
)


@pytest.fixture
def cable():
    """Two machines, whose interfaces `usb0` know each other as fe80::a and fe80::b."""
    ends = {_LAPTOP: "fe80::a/64", _BRICK: "fe80::b/64"}
    try:
        for name in ends:
            ip("netns", "add", name)
        ip("link", "add", "usb0", "netns", _LAPTOP, "type", "veth",
           "peer", "name", "usb0", "netns", _BRICK)  # fmt: skip
        for name, address in ends.items():
            ip("-n", name, "link", "set", "usb0", "addrgenmode", "none", "up")
            ip("-n", name, "address", "add", address, "dev", "usb0", "nodad")
        yield
    finally:
        for name in ends:
            ip("netns", "delete", name, check=False)


@contextmanager
def on_brick(*words):
    """A program of the brick, once it has said that it is ready."""
    process = subprocess.Popen(
        ["ip", "netns", "exec", _BRICK, sys.executable, *words],
        cwd=ROOT,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout.readline().startswith("READY")
        yield
    finally:
        process.terminate()
        process.communicate(timeout=PATIENCE_S)


def kickctl(*words):
    """(exit status, JSON answer) of kickctl on the laptop."""
    done = subprocess.run(
        ["ip", "netns", "exec", _LAPTOP, sys.executable, "-m", "kickctl", *words, "--json"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    return done.returncode, json.loads(done.stdout)


def test_a_robot_is_found_and_stopped_over_ipv6_alone(cable, tmp_path):
    robot = ("-m", "sim_motor", "--host", "::", "--token", str(tmp_path / "token"))
    with on_brick(*robot), on_brick("-c", ANNOUNCE):
        status, answer = kickctl("discover", "--seconds", LISTEN_S)
        assert status == 0
        (found,) = answer["robots"]
        assert (found["name"], found["uri"]) == ("runner", "tcp://[fe80::b%usb0]")
        status, answer = kickctl("stop", "--brick", found["uri"])
        assert (status, answer["state"], answer["brick"]) == (0, "stopped", found["uri"])


def test_nobody_on_the_cable_is_said(cable):
    status, answer = kickctl("discover", "--seconds", "0.5")
    assert (status, answer["robots"]) == (3, [])
