"""kickctl doctor."""

from __future__ import annotations

import argparse
import platform
import shutil
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from host.client.robot import Robot, connect
from host.commands._hints import as_typed
from host.commands._terminal import show
from host.commands.status import WITHOUT_PRIORITY
from host.errors import KickctlError, NotDone
from host.link.names import chosen, own_token
from host.util.installation import deploy_command, install_command
from robot import __version__
from robot.sources import of_robot
from robot.token import TokenError, default_path, load

HELP = "check this machine, the link and the robot, and say what to mend"

LEAST_DISK_BYTES = 100_000_000
PINGS = 20
LOW_BATTERY_V = 6.5
# Share of the ticks. A robot that misses more does not see its own wheels turn evenly.
MANY_MISSED = 0.01


@dataclass(frozen=True)
class Finding:
    """What one check has found. `remedy` is empty if all is well."""

    what: str
    found: str
    remedy: str = ""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add nothing: it has no arguments of its own."""


def run(options: argparse.Namespace) -> int:
    """Check everything without moving anything.

    Raises:
        KickctlError: Something needs mending, or the robot is out of reach.
    """
    findings = [*_machine(), *_token(options.token or _own_token(options.brick))]
    failure: KickctlError | None = None
    try:
        with connect(options.brick, options.seed, options.token) as robot:
            findings += _robot(robot)
    except KickctlError as error:
        findings.append(Finding("robot", error.message, error.hint or "see above"))
        failure = error
    except ImportError as error:
        findings.append(Finding("robot", f"not tried: {error}", "install the libraries first"))
    if options.json:
        show(
            {
                "findings": [
                    {**asdict(finding), "remedy": as_typed(finding.remedy)} for finding in findings
                ],
                "well": not any(finding.remedy for finding in findings),
            }
        )
    else:
        for finding in findings:
            print(
                f"{'!!' if finding.remedy else 'ok'}  {finding.what}: {finding.found}"
                + (f"\n      {as_typed(finding.remedy)}" * bool(finding.remedy))
            )
    if failure is not None:
        raise failure
    ill = [finding.what for finding in findings if finding.remedy]
    if ill:
        raise NotDone(f"not well: {', '.join(ill)}", "the answer says what to do")
    return 0


def _machine() -> Iterator[Finding]:
    yield Finding(
        "Python",
        platform.python_version(),
        "" if sys.version_info >= (3, 11) else "install Python 3.11 or newer",
    )
    yield from _libraries()
    free = shutil.disk_usage(Path.cwd()).free
    yield Finding(
        "disk",
        f"{free / 1e9:.1f} GB free here",
        "" if free > LEAST_DISK_BYTES else "logs need room: delete old ones",
    )


def _libraries() -> Iterator[Finding]:
    """What the package's own metadata requires, first always and then for each extra."""
    # Every other verb starts sooner without these.
    from importlib.metadata import PackageNotFoundError

    from host.util import requirements

    try:
        extras = requirements.missing()
        absent = extras.pop("")
    except PackageNotFoundError:
        yield Finding(
            "libraries",
            "kickctl runs from its folder without being installed: nobody knows what is missing",
            f"install it: {install_command()}",
        )
        return
    except ImportError as error:
        yield Finding("libraries", str(error), f"install what is missing: {install_command()}")
        return
    yield Finding(
        "libraries",
        f"missing: {', '.join(absent)}" if absent else "all there",
        f"install them: {install_command()}" if absent else "",
    )
    for extra, names in extras.items():
        found = f"not installed ({', '.join(names)}); to get it: {install_command(extra)}"
        yield Finding(f"extra {extra}", found if names else "all there")


def _own_token(brick: str | None) -> str | None:
    """The token file of the robot that is named; None if it has none, or is no robot."""
    try:
        return own_token(chosen(brick))
    except KickctlError:  # connecting says it too
        return None


def _token(path: str | None) -> Iterator[Finding]:
    chosen = path or default_path()
    if not (chosen and Path(chosen).exists()):
        place = f"at {chosen}" if chosen else "and no home folder to keep it in"
        yield Finding("token", f"none {place}; only a robot on another machine needs one")
        return
    try:
        load(chosen)
    except TokenError as error:
        yield Finding("token", error.why, error.remedy or "copy the robot's token file here again")
    else:
        yield Finding("token", chosen)


def _robot(robot: Robot) -> Iterator[Finding]:
    from statistics import median

    hello = robot.hello
    same = hello["software"] == __version__
    yield Finding("robot", f"{robot.link.uri}, {hello['machine']}")
    yield Finding(
        "software",
        f"host {__version__}, robot {hello['software']}",
        "" if same else "run the same release on both",
    )
    yield _sources(hello.get("sources", ""))
    yield Finding(
        "access",
        "token accepted"
        if robot.trusted
        else "another robot's token: you may look, and stop the robot"
        if robot.token_refused
        else "no token: you may look, and stop the robot",
        (
            ""
            if robot.trusted
            else f"{deploy_command()} copies it; or copy the robot's token file, and chmod 600 it"
        ),
    )
    delays = []
    for _ in range(PINGS):
        asked = time.perf_counter()
        status = robot.status()
        delays.append(1000 * (time.perf_counter() - asked))
    slow = median(delays) > 100.0
    yield Finding(
        "link",
        f"an answer takes {median(delays):.1f} ms (median of {PINGS}), {max(delays):.1f}"
        " ms at most",
        "use a cable, or come nearer" if slow else "",
    )
    fault = status["state"] == "fault"
    yield Finding(
        "state",
        f"{status['state']} ({status['reason']})",
        "mend the cause, then: kickctl clear, kickctl start" if fault else "",
    )
    yield _battery(status["battery_v"])
    yield _schedule(status)
    yield _punctuality(status)


def _sources(robots: str) -> Finding:
    """Whether robot and host run the same code: two checkouts can have one version."""
    if robots == of_robot():
        return Finding("sources", f"robot and host run the same ({robots})")
    return Finding(
        "sources",
        (
            f"robot and host run different ones ({robots}, {of_robot()})"
            if robots
            else "the robot's release does not say them"
        ),
        f"bring this release to the robot: {deploy_command()}",
    )


def _battery(volts: float | None) -> Finding:
    if volts is None:
        return Finding("battery", "the robot does not measure it")
    return Finding("battery", f"{volts:.2f} V", "charge it" if volts < LOW_BATTERY_V else "")


def _schedule(status: dict[str, Any]) -> Finding:
    """What keeps other programs from delaying ticks. A robot works without it, too."""
    if status.get("real_time") is None:
        return Finding("schedule", "unknown")
    if not status["real_time"]:
        return Finding("schedule", WITHOUT_PRIORITY)
    locked = "never" if status["memory_locked"] else "may be"
    return Finding("schedule", f"real-time priority; memory {locked} swapped out")


def _punctuality(status: dict[str, Any]) -> Finding:
    counts, edges = status["lateness"]["counts"], [*status["lateness"]["edges_s"], float("inf")]
    total, passed, bound = sum(counts), 0, 0.0
    for count, edge in zip(counts, edges, strict=True):
        passed += count
        bound = edge
        if passed >= 0.99 * total:
            break
    missed = status["missed"] / max(1, total)
    text = (
        f"99 % of {total} ticks began at most {1000 * bound:g} ms late; {status['missed']} missed,"
        f" {status['overruns']} longer than the control period"
    )
    return Finding(
        "ticks",
        text,
        (
            "end other programs on the robot, or choose a longer control period:"
            " kickctl params set tick_s=0.04"
            if missed > MANY_MISSED
            else ""
        ),
    )
