"""`make faults`: every fault tried many times, and a table of how long the motors ran on at worst and what the host was told.

The robot's program, a host and the kernel's files (FUSE, with the motors' physics) are processes of
their own. Times run from the fault until the files show that no motor is driven, in real time on
this machine. Returns 1 if a row fails.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from random import Random
from typing import NamedTuple
from unittest import mock

from host.errors import KickctlError
from tests.fault_rows import ROWS
from tests.live import Live, impatient
from tests.sysfs.mount import mounted, why_not

TRIES = 20


class Result(NamedTuple):
    """What came of a row: the times in s, None where there is none; the first words to the host.

    And what failed, in words.
    """

    seconds: list
    told: str
    failures: list


def attempt(row, folder, scratch, tries, chance):
    """The Result of so many tries of a row on the mount at `folder`."""
    result = Result([], "", [])
    environment = row.environment(scratch)
    done = 0
    while done < tries:
        # A robot on which a try has failed serves no more.
        with Live(
            folder,
            *row.arguments,
            program=row.program,
            environment=environment,
            relayed=row.relayed,
        ) as live:
            well = True
            while done < tries and well:
                done += 1
                try:
                    seconds, told = row.attempt(live, chance)
                    assert row.words in told, f"the host is told '{told}'"
                    result.seconds.append(seconds)
                    result = result._replace(told=result.told or told)
                except (AssertionError, KickctlError, OSError, subprocess.SubprocessError) as error:
                    result.failures.append(f"{type(error).__name__}: {error}")
                well = row.lasting and not result.failures
    return result


def line(row, result):
    """(a row of the table, whether it holds)."""
    times = [seconds for seconds in result.seconds if seconds is not None]
    worst = max(times, default=None)
    late = row.limit_s is not None and (worst is None or worst > row.limit_s)
    verdict = "fails" if result.failures else "late" if late else "holds"
    cells = (
        row.name,
        f"{len(result.seconds)}/{len(result.seconds) + len(result.failures)}",
        "goes on" if worst is None else f"{1000 * sum(times) / len(times):.0f}",
        "" if worst is None else f"{1000 * worst:.0f}",
        "" if row.limit_s is None else f"{1000 * row.limit_s:.0f}",
        result.told or "nothing",
        verdict,
    )
    return "| " + " | ".join(cells) + " |", verdict == "holds"


def main():
    """Print the table as it grows. Returns the exit status."""
    arguments = argparse.ArgumentParser(description="Brings about what can go wrong with a robot.")
    arguments.add_argument("rows", nargs="*", help="words of the rows to try (default: all)")
    arguments.add_argument("--tries", type=int, default=TRIES)
    arguments.add_argument("--seed", type=int, default=1)
    options = arguments.parse_args()
    if why_not():
        print(f"make faults: {why_not()}", file=sys.stderr)
        return 2
    chance = Random(options.seed)
    rows = [
        row for row in ROWS if not options.rows or any(word in row.name for word in options.rows)
    ]
    all_hold = True
    print(
        f"Load of the machine {os.getloadavg()[0]:.1f}, {os.cpu_count()} processors, seed"
        f" {options.seed}\n"
    )
    print(
        "| fault | tries | mean / ms | worst / ms | limit / ms | the host is told |"
        " |\n|---|---|---|---|---|---|---|",
        flush=True,
    )
    with (
        tempfile.TemporaryDirectory() as scratch,
        impatient(),
        mock.patch.dict(os.environ, {"KICK_TOKEN": f"{scratch}/token"}),
        mounted(Path(scratch) / "sys", "--seed", str(options.seed)) as folder,
    ):
        for row in rows:
            print(f"{row.name} ...", file=sys.stderr, flush=True)
            if row.lacks():
                print(f"| {row.name} | | | | | | not tried: {row.lacks()} |", flush=True)
                continue
            began = time.monotonic()
            result = attempt(row, folder, Path(scratch), options.tries, chance)
            text, holds = line(row, result)
            all_hold = all_hold and holds
            print(text, flush=True)
            for failure in result.failures:
                print(f"  {failure}", file=sys.stderr)
            print(f"  {time.monotonic() - began:.0f} s", file=sys.stderr, flush=True)
    return 0 if all_hold else 1


if __name__ == "__main__":
    sys.exit(main())
