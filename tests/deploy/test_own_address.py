"""What deploy.sh keeps of a robot leads to it even after its brick has got another address.

A program that listens at every address is reached at the brick's 127.0.0.1, through ssh.
"""

import json
import os
import subprocess
import sys
from contextlib import contextmanager

import pytest

from tests.deploy.brick import ROOT, free_port, needs_sshd, write

# The brick's own address is what stands in a file.
OWN_ADDRESS = """

def own_address():
    with open({!r}) as file:
        return file.read()
"""
HARDWARE_ID = "0123456789abcdef" * 2
FIRST = "127.0.0.2"
LATER = "203.0.113.7"  # of a network for documentation: nobody answers there
# A program that listens as the robot's does, and at a port of its own besides; it tells the first.
LISTENER = """
import select, socket, sys
from robot.server import Server
other = socket.create_server(("127.0.0.3", 0))
server = Server.__new__(Server)
server._poll = select.epoll()
print(server.listen(sys.argv[1], 0), flush=True)
sys.stdin.read()
"""


@pytest.fixture
def own(tmp_path):
    """Where the brick's own address stands."""
    path = tmp_path / "own_address"
    write(path, FIRST)
    return path


@pytest.fixture
def anywhere(brick, checkout, own):
    """What deploys a program that listens at every address: the environment for it, and its port.

    The brick has a hardware id.
    """
    checkout.change("program", OWN_ADDRESS.format(str(own)))
    checkout.change("hardware", f'\n\ndef hardware_id():\n    return "{HARDWARE_ID}"\n')
    port = free_port()
    return {"KICK_ROBOT_ARGS": f"--sysfs {brick.sysfs} --port {port} --seed 5"}, port


@pytest.fixture
def anna(checkout, anywhere):
    """Deploys from a machine that has a kickctl, and calls the robot anna."""
    kickctl = f'#!/bin/sh\ncd {ROOT} && exec {sys.executable} -m host "$@"\n'
    write(checkout.bin / "kickctl", kickctl, 0o755)
    return lambda *words: checkout.deploy(*words, KICK_AS="anna", **anywhere[0])


def known(checkout):
    return json.loads(checkout.kickctl("robots", "list", "--json")[1])["robots"]


@needs_sshd
def test_a_name_leads_to_the_robot_after_its_brick_has_got_another_address(
    brick, checkout, anywhere, anna, own
):
    status, output = anna()
    assert status == 0, output
    port = anywhere[1]
    assert known(checkout)["anna"]["address"] == f"ssh://brick?port={port}"
    brick.stop_program()
    write(own, LATER)
    # Or start_program would not wait for the new READY.
    (brick.kickctl / "robot.log").unlink()
    brick.start_program()
    assert f"READY tcp://{LATER}:{port}" in brick.log()
    assert '"seed": 5,' in checkout.kickctl("--brick", "anna", "status", "--json")[1]
    status, _, err = checkout.kickctl("--brick", "anna", "stop")
    assert status == 0, err
    status, output = anna("--status")
    assert status == 0, output
    assert f"READY at every address of the brick, port {port}" in output
    assert LATER not in output


@needs_sshd
@pytest.mark.parametrize("hardware_id", [HARDWARE_ID, None])
def test_a_deploy_renews_a_name_that_has_an_address_of_the_brick(
    checkout, anywhere, anna, hardware_id
):
    old = f"ssh://brick?host={LATER}&port={anywhere[1]}"
    write(checkout.token, "00" * 32 + "\n", 0o600)
    more = () if hardware_id is None else ("--hardware-id", hardware_id)
    add = ("robots", "add", "anna", old, "--token", str(checkout.token), *more)
    assert checkout.kickctl(*add)[0] == 0
    status, output = anna()
    assert status == 0, output
    assert "The robot is known here as anna" in output
    assert known(checkout) == {
        "anna": {
            "address": f"ssh://brick?port={anywhere[1]}",
            "token": str(checkout.token),
            "hardware_id": HARDWARE_ID,
        }
    }


@contextmanager
def listening(home, host):
    """A program that listens at a host of this machine, as brick.sh knows it: its port."""
    release = home / "kickctl" / "releases" / "one"
    release.mkdir(parents=True)
    (home / "kickctl" / "current").symlink_to(release)
    with subprocess.Popen(
        [sys.executable, "-c", LISTENER, host],
        cwd=release,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            write(home / "kickctl" / "robot.pid", f"{process.pid}\n")
            yield int(process.stdout.readline())
        finally:
            process.terminate()


@pytest.mark.parametrize(
    ("host", "ready", "reached"),
    [
        ("0.0.0.0", "192.0.2.2", ""),  # noqa: S104
        ("0", "192.0.2.2", ""),
        ("::", "192.0.2.2", ""),
        ("::", "[::]", ""),  # as a release says it that is older than its own address
        ("::ffff:0.0.0.0", "192.0.2.2", ""),
        ("127.0.0.1", "127.0.0.1", ""),
        ("localhost", "localhost", ""),
        ("127.0.0.2", "127.0.0.2", "127.0.0.2"),
        ("::1", "[::1]", "::1"),
        ("::ffff:127.0.0.2", "[::ffff:127.0.0.2]", "::ffff:127.0.0.2"),
    ],
)
def test_where_a_program_is_reached(tmp_path, host, ready, reached):
    log = tmp_path / "kickctl" / "robot.log"
    with listening(tmp_path, host) as port:
        write(log, f"starting\nREADY tcp://10.0.0.9:1\nstarting\nREADY tcp://{ready}:{port}\n")
        done = subprocess.run(
            ["sh", ROOT / "robot" / "service" / "brick.sh", "address"],
            env={"HOME": str(tmp_path), "KICK_RUN": str(tmp_path / "run"), "PATH": "/usr/bin:/bin"},
            capture_output=True,
            text=True,
            check=True,
        )
    assert done.stdout.splitlines()[0] == f"kickctl-address={reached}:{port}="
