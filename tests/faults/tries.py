"""Try a row of the table of faults many times, and say what came of it."""

import subprocess
from typing import NamedTuple

from host.errors import KickctlError
from tests.live import Live


class Result(NamedTuple):
    """What came of a row: the times in s, None where there is none; the first words to the host.

    And what failed, in words.
    """

    seconds: list
    reason: str
    failures: list


def attempt(row, folder, scratch, tries, chance):
    """The Result of `tries` tries of a row on the mount at `folder`."""
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
                    seconds, reason = row.attempt(live, chance)
                    assert row.words in reason, f"the host got another reason: '{reason}'"
                    result.seconds.append(seconds)
                    result = result._replace(reason=result.reason or reason)
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
        result.reason or "nothing",
        verdict,
    )
    return "| " + " | ".join(cells) + " |", verdict == "holds"
