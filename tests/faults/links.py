"""Faults of the link, and what else comes over it."""

import socket
import subprocess
import sys
import time

from robot import wire
from robot.params import TABLE
from tests.live import PORTS
from tests.sysfs.mount import ROOT

TICK_S = TABLE["tick_s"].default
LINK_LOSS_S = TABLE["link_loss_s"].default
# How much longer than the time after which a link counts as lost it is cut, where nothing stops.
MARGIN_S = 0.25


def cut_link(policy):
    """No byte passes between host and robot for a while; then they go on."""

    def attempt(live, chance):
        live.robot.lease()
        live.robot.set(link_loss=policy)
        live.run(chance)
        first = len(live.log.events)
        with live.watch() as watch:
            since = time.monotonic()
            live.relay.silent = True
            try:
                if policy == "continue":
                    time.sleep(LINK_LOSS_S + MARGIN_S)
                    assert watch.running() == len(PORTS)
                    seconds = None
                else:
                    seconds = watch.stopped_after(since)
            finally:
                live.relay.silent = False
            reason = live.reason_of("link_loss", first)
            state = live.state()
            assert state == {"stop": "stopped", "hold": "held", "continue": "running"}[policy], (
                state
            )
            live.robot.lease()
            assert live.state() == {"stop": "stopped"}.get(policy, "running")
        return seconds, reason

    return attempt


_HOLDER = """
import sys, time
from host.client.robot import connect
with connect(sys.argv[1], name="killed host") as robot:
    robot.lease()
    robot.set(link_loss="stop")
    print("ready", flush=True)
    time.sleep(3600)
"""


def kill_host(live, chance):
    live.run(chance)
    live.robot.release()
    first = len(live.log.events)
    with (
        subprocess.Popen(
            [sys.executable, "-c", _HOLDER, live.address], cwd=ROOT, stdout=subprocess.PIPE
        ) as host,
        live.watch() as watch,
    ):
        try:
            host.stdout.readline()
            time.sleep(chance.uniform(0.1, 0.4))
            assert watch.running() == len(PORTS)
        finally:
            since = time.monotonic()
            host.kill()
        seconds = watch.stopped_after(since)
    reason = live.reason_of("link_loss", first)
    assert "killed host" in reason
    return seconds, reason


def send_stop_frame(live, chance):
    """Somebody without token or greeting sends a stop frame."""
    live.run(chance)
    first = len(live.log.events)
    with (
        live.watch() as watch,
        socket.create_connection(("127.0.0.1", int(live.address.rpartition(":")[2]))) as stranger,
    ):
        time.sleep(chance.uniform(0.0, 2 * TICK_S))
        since = time.monotonic()
        stranger.sendall(wire.encode(wire.STOP, b""))
        seconds = watch.stopped_after(since)
    return seconds, live.reason_of("stop", first)
