"""kickctl stop."""

from __future__ import annotations

import argparse
import threading
from contextlib import suppress
from queue import SimpleQueue
from typing import Any

from host.client.stop import Stopped, stop_robot
from host.commands._failures import in_words
from host.commands._hints import name_robot
from host.commands._side_by_side import Outcome, failed, show_each
from host.commands._terminal import answer
from host.errors import WrongUse
from host.link.addresses import sim_options
from host.link.names import ALL, chosen, every, is_several, link_to, named
from host.link.robots_file import Known

HELP = (
    "stop the motors. It needs no token, and works with a robot of another version. Without"
    " --brick it stops every robot that has a name"
)
_NAME_ONE = (
    "name the robot, as in kickctl --brick tcp://ev3dev.local stop, or press the back button on the"
    " brick"
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """No arguments of its own."""


def run(options: argparse.Namespace) -> int:
    """Send the STOP frame before anything else, and wait until each robot confirms it.

    Returns:
        0 if all have confirmed it, else the highest exit status of those that have not.
    """
    text = named(options.brick)
    if text in (None, ALL):
        return _stop_all(options, _all_known())
    if is_several(text):
        # One that is unknown must not keep the others from being stopped.
        names = [name.strip() for name in text.split(",")]
        if ALL in names:
            with suppress(WrongUse):  # no robot has a name, which is said of 'all'
                known = _all_known()
                names = [name for name in dict.fromkeys([*known, *names]) if name != ALL]
        return _stop_all(options, names)
    robot = chosen(text)
    stopped = _stop(robot, options.seed)
    answer(options, _result(robot, stopped), stopped.sentence())
    return 0


def _all_known() -> list[str]:
    try:
        return [robot.name for robot in every()]
    except WrongUse as error:
        raise WrongUse(
            f"none has been stopped, since no robot is named here: {error.message}",
            f"{_NAME_ONE}. {error.hint}",
        ) from error


def _stop(robot: Known, seed: int | None) -> Stopped:
    """Stop one robot. Raises KickctlError if nobody has confirmed it, or a motor did not obey."""
    if sim_options(robot.address) is not None:
        raise WrongUse(
            "no robot of its own is named, so none has been stopped: a simulated robot is embedded"
            " in each command, and ends with it",
            _NAME_ONE,
        )
    stopped = stop_robot(link_to(robot, seed))
    stopped.require_obeyed()
    return stopped


def _stop_all(options: argparse.Namespace, names: list[str]) -> int:
    """Stop robots side by side: none waits for another one. Say of each what is known."""
    ends: SimpleQueue[tuple[str, tuple[Known, Stopped] | BaseException]] = SimpleQueue()

    def stop(name: str) -> None:
        try:
            robot = chosen(name)
            ends.put((name, (robot, _stop(robot, options.seed))))
        except BaseException as error:  # noqa: BLE001 - it is said below
            ends.put((name, error))

    for name in names:
        threading.Thread(target=stop, args=(name,), daemon=True).start()
    outcomes = (_outcome(*ends.get(), options.token) for _ in names)
    return show_each(options, names, outcomes)


def _outcome(name: str, end: tuple[Known, Stopped] | BaseException, token: str | None) -> Outcome:
    if isinstance(end, tuple):
        robot, stopped = end
        return Outcome(name, _result(robot, stopped), stopped.sentence(), 0)
    failure = in_words(end)
    if failure is None:
        raise end
    name_robot(name, token)  # in the hint
    return failed(name, failure)


def _result(robot: Known, stopped: Stopped) -> dict[str, Any]:
    return {"brick": robot.address, "state": stopped.state, "tick": stopped.tick}
