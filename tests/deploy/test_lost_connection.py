"""A connection to the brick that cannot be made, or is cut during a deploy."""

import socket
import threading
from contextlib import contextmanager, suppress

import pytest

from tests.deploy.brick import needs_sshd, wait_until

pytestmark = needs_sshd


@contextmanager
def cut_after(brick, to_brick):
    """Everything between ssh and the brick goes through here, until a number of bytes has passed.

    Then the line is dead.
    """
    listener = socket.create_server(("127.0.0.1", 0))
    links = []

    def carry(source, target, budget):
        with suppress(OSError):
            while budget > 0 and (data := source.recv(min(4096, budget))):
                target.sendall(data)
                budget -= len(data)
            cut()

    def cut():
        for link in links:
            with suppress(OSError):
                link.shutdown(socket.SHUT_RDWR)

    def serve():
        with suppress(OSError):
            near = listener.accept()[0]
            listener.close()
            far = socket.create_connection(("127.0.0.1", brick.port))
            links.extend((near, far))
            threading.Thread(target=carry, args=(far, near, 10**9), daemon=True).start()
            carry(near, far, to_brick)

    server = threading.Thread(target=serve, daemon=True)
    server.start()
    brick.reach_through(listener.getsockname()[1])
    try:
        yield cut
    finally:
        cut()
        listener.close()
        server.join(10)
        for link in links:
            link.close()
        brick.reach_through(brick.port)


@pytest.mark.parametrize("sent", [100, 12000, 30000])
def test_a_connection_cut_in_the_upload_leaves_the_old_release(deployed, checkout, sent):
    release, pid = deployed.release(), deployed.pid()
    with cut_after(deployed, sent):
        status, output = checkout.deploy()
    assert status == 3, output
    assert "no connection" in output
    assert (deployed.pid(), deployed.release()) == (pid, release)
    status, output = checkout.deploy()
    assert status == 0, output
    assert deployed.runs() == deployed.release() != release
    assert not [name for name in deployed.releases() if name.startswith(".")]


def test_a_connection_cut_in_the_change_over_does_not_stop_it(deployed, checkout):
    """The brick goes on without anybody who looks, and has a program that runs in the end."""
    release = deployed.release()
    with cut_after(deployed, 10**9) as cut, checkout.deploying() as process:
        wait_until(lambda: deployed.pid() is None)
        cut()
        output = process.communicate(timeout=60)[0]
        assert process.returncode == 3, output
    wait_until(lambda: deployed.release("previous") == release)
    assert deployed.runs() == deployed.release() != release
    assert checkout.deploy("--status")[0] == 0


def test_a_connection_cut_in_the_change_over_to_a_bad_release_rolls_back(deployed, checkout):
    release = deployed.release()
    checkout.change("params", "\nimport time\ntime.sleep(1)\nraise RuntimeError('no')\n")
    with cut_after(deployed, 10**9) as cut, checkout.deploying() as process:
        wait_until(lambda: deployed.runs() not in (None, release))
        cut()
        process.communicate(timeout=60)
    wait_until(
        lambda: deployed.runs() == deployed.release() == release and "READY" in deployed.log()
    )


def test_no_brick_at_the_address_is_told_in_words(checkout, brick):
    brick.reach_through(1)
    status, output = checkout.deploy()
    assert status == 3
    assert "Connection refused" in output
    assert "address on its screen" in output


def test_a_name_that_nobody_has_is_told_with_how_to_find_another(checkout):
    status, output = checkout.deploy(to="robot@nowhere.invalid")
    assert status == 3
    assert "the network knows no nowhere.invalid: kickctl discover" in output
