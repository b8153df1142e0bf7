"""`make soak`: kick, cut off, stop and break a robot at random for an hour ($SOAK_S seconds).

Nothing may be lost: every tick of the robot is in the host's log, which is recorded as a person
would record it. Nothing may grow: the memory and the open files of the robot's process. Returns 1
if anything did.
"""

import os
import sys
import tempfile
import time
from collections import Counter
from contextlib import suppress
from math import nan, sqrt
from pathlib import Path
from random import Random
from unittest import mock

import numpy as np
from scipy.stats import t

from host.errors import KickctlError
from host.logs.log import Log
from host.logs.mcap_files import McapTap
from robot.params import TABLE
from tests.live import PORTS, Live, open_files, wait_until
from tests.sysfs.mount import mounted, why_not

HOUR_S = 3600.0
# What the robot remembers of its past grows until it is full: the journal, 2000 events of less than
# a kilobyte each.
REMEMBERED_KB = 2000
BLOCKS = 12
KICKS = (
    {"mode": "membrane"},
    {"mode": "position"},
    {"mode": "phase", "ticks": 4},
    {"mode": "jump", "variable": "x1", "delta": 1.0},
)
LINK_LOSS = TABLE["link_loss"].choices


class Tally:
    """A tap that remembers only whether the ticks follow one another."""

    def __init__(self):
        self.ticks = 0
        self.gaps = []
        self.events = Counter()
        self.missed = 0
        self._due = None

    def take_records(self, records):
        for record in records:
            if self._due is not None and record.tick != self._due:
                self.gaps.append((self._due, record.tick))
            self._due = record.tick + 1
            self.ticks += 1
            self.missed += record.missed

    def take_event(self, event):
        self.events[event["event"]] += 1


class Vitals:
    """Memory (kB) and open files of a process, over time."""

    def __init__(self, pid):
        self._pid = pid
        self.samples = []

    def look(self):
        pages = int(Path(f"/proc/{self._pid}/statm").read_text(encoding="ascii").split()[1])
        self.samples.append(
            (time.monotonic(), pages * os.sysconf("SC_PAGE_SIZE") // 1024, open_files(self._pid))
        )

    def growth(self):
        """(slope, half of its 95 % interval) of the memory in kB/h, without the first quarter.

        What is used for the first time grows there. Samples that follow one another are nearly the
        same, so the line goes through the means of blocks of them.
        """
        late = np.array(self.samples[len(self.samples) // 4 :])[:, :2]
        if len(late) < BLOCKS:
            return nan, nan
        times, sizes = np.transpose([block.mean(axis=0) for block in np.array_split(late, BLOCKS)])
        (slope, _), covariance = np.polyfit(times - times.mean(), sizes, 1, cov=True)
        error = sqrt(covariance[0, 0])
        return HOUR_S * slope, HOUR_S * error * t.ppf(0.975, BLOCKS - 2)


def kick(live, chance):
    """The robot may be busy with a kick before."""
    with suppress(KickctlError):
        live.robot.kick(**chance.choice(KICKS))


def stop(live, chance):
    live.robot.stop()
    time.sleep(chance.uniform(0.0, 0.5))


def cut(live, chance):
    """All connections break, and for a while there are no new ones."""
    live.robot.set(link_loss=chance.choice(LINK_LOSS))
    live.relay.cut(chance.uniform(0.0, 3.0))


def silence(live, chance):
    """Connections stay, and nothing passes."""
    live.robot.set(link_loss=chance.choice(LINK_LOSS))
    live.relay.silent = True
    time.sleep(chance.uniform(0.0, 2.0))
    live.relay.silent = False


def unplug(live, chance):
    port = chance.choice(PORTS)
    live.inject("unplug " + port)
    time.sleep(chance.uniform(0.0, 0.5))
    live.inject("replug " + port)


def disturb(live, chance):
    live.inject(f"eio {chance.choice(PORTS)} {chance.randint(1, 8)}")


ACTIONS = ((kick, 8), (stop, 2), (cut, 2), (silence, 2), (unplug, 1), (disturb, 1))


def recover(live):
    """Bring it to run again, as a person would."""
    live.robot.lease()

    def runs():
        state = live.state()
        if state == "fault":
            live.refusal(live.robot.clear)
        elif state != "running":
            live.refusal(live.robot.start)
        return state == "running"

    wait_until(runs, "the robot runs again")


def soak(live, seconds, chance, path):
    """(Tally, Vitals, Counter of the actions) of so many seconds."""
    tally, vitals, done = Tally(), Vitals(live.process.pid), Counter()
    recover(live)
    actions, weights = zip(*ACTIONS, strict=True)
    with McapTap(path, live.robot.info()) as tap:
        for one in (tap, tally):
            live.robot.add_tap(one)
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            action = chance.choices(actions, weights)[0]
            action(live, chance)
            done[action.__name__] += 1
            recover(live)
            live.robot.wait(chance.uniform(0.5, 3.0))
            recover(live)
            vitals.look()
            left = until - time.monotonic()
            print(
                f"\r{max(0.0, left):5.0f} s left, {tally.ticks} ticks, {sum(done.values())}"
                " actions ",
                end="",
                file=sys.stderr,
                flush=True,
            )
        for one in (tap, tally):
            live.robot.remove_tap(one)
    print(file=sys.stderr)
    return tally, vitals, done


def verdicts(tally, vitals, log):
    """Yields what is wrong, in words."""
    if tally.gaps or tally.events["lost"]:
        yield f"ticks are missing: {tally.gaps}"
    if log.missing() or len(log) != tally.ticks:
        yield f"the recorded log has {len(log)} ticks of {tally.ticks}, and gaps {log.missing()}"
    sizes, files = (
        [size for _, size, _ in vitals.samples],
        {count for _, _, count in vitals.samples},
    )
    if max(sizes) > sizes[0] + REMEMBERED_KB:
        yield f"its memory grew from {sizes[0]} to {max(sizes)} kB"
    if len(files) > 1:
        yield f"its open files are not always as many: {sorted(files)}"


def main():
    """Print what was done and seen. Returns the exit status."""
    if why_not():
        print(f"make soak: {why_not()}", file=sys.stderr)
        return 2
    seconds = float(os.environ.get("SOAK_S", HOUR_S))
    seed = int(os.environ.get("SOAK_SEED", time.time_ns() % 2**31))
    print(f"{seconds:g} s, seed {seed} (SOAK_SEED={seed} does the same again)", flush=True)
    with (
        tempfile.TemporaryDirectory() as scratch,
        mock.patch.dict(os.environ, {"KICK_TOKEN": f"{scratch}/token"}),
    ):
        path = Path(scratch) / "soak.mcap"
        with (
            mounted(Path(scratch) / "sys", "--seed", str(seed)) as folder,
            Live(folder, "--seed", str(seed), relayed=True) as live,
        ):
            live.robot.remove_tap(live.log)
            tally, vitals, done = soak(live, seconds, Random(seed), path)
            status = live.robot.status()
        wrong = list(verdicts(tally, vitals, Log.load(path)))
    sizes = [size for _, size, _ in vitals.samples]
    slope, half = vitals.growth()
    print("actions: " + ", ".join(f"{name} {count}" for name, count in done.most_common()))
    print("events: " + ", ".join(f"{name} {count}" for name, count in tally.events.most_common()))
    print(
        f"ticks: {tally.ticks}, missing {sum(end - first for first, end in tally.gaps)}; deadlines"
        f" missed {status['missed']}"
    )
    print(
        f"memory: {sizes[0]} kB at the start, {sizes[-1]} at the end, {max(sizes)} at most; it grew"
        f" by {slope:z.0f} kB/h (95 % interval: {slope - half:z.0f} to {slope + half:z.0f})"
    )
    print(
        "open files:"
        f" {', '.join(str(count) for count in sorted({count for _, _, count in vitals.samples}))}"
    )
    for sentence in wrong:
        print("wrong: " + sentence)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
