"""`make faults`: try every fault many times; how long the motors ran on, what the host heard.

The robot's program, a host and the kernel's files (FUSE, with the motors' physics) are processes of
their own. Times run from the fault until the files show that no motor is driven, in real time on
this machine. Returns 1 if a row fails.
"""

import argparse
import os
import sys
import tempfile
import time
from pathlib import Path
from random import Random
from unittest import mock

from tests.faults.rows import ROWS
from tests.faults.tries import attempt, line
from tests.live import impatient
from tests.sysfs.mount import mounted, why_not

TRIES = 20


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
