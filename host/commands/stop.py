"""kickctl stop."""

from __future__ import annotations

import argparse
import threading
from contextlib import suppress
from itertools import chain
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
from host.link.robots_file import Known, read_sound

HELP = (
    "stop the motors. It needs no token, and works with a robot of another version. Without"
    " --brick it stops every robot that has a name"
)
# In place of a name, which it cannot be: whatever robots a spoiled file does not tell.
OTHERS = "robots.toml"
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
        return _stop_all(options, *_all_known())
    if is_several(text):
        # One that is unknown must not keep the others from being stopped.
        names, failure = [name.strip() for name in text.split(",")], None
        if ALL in names:
            with suppress(WrongUse):  # no robot has a name, which is said of 'all'
                known, failure = _all_known()
                names = [name for name in dict.fromkeys([*known, *names]) if name != ALL]
        return _stop_all(options, names, failure)
    robot = chosen(text)
    stopped = _stop(robot, options.seed)
    answer(options, _result(robot, stopped), stopped.sentence())
    return 0


def _all_known() -> tuple[list[str], WrongUse | None]:
    """The names of all robots; and why there may be more, if the file of robots is spoiled."""
    try:
        return [robot.name for robot in every()], None
    except WrongUse as error:
        names = list(read_sound()[0])
        extent = (
            "there may be more robots" if names else "none has been stopped, since none is named"
        )
        failure = WrongUse(f"{extent}: {error.message}", f"{_NAME_ONE}. Then {error.hint}")
        if not names:
            raise failure from error
        return names, failure


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


def _stop_all(
    options: argparse.Namespace, names: list[str], failure: WrongUse | None = None
) -> int:
    """Stop robots side by side: none waits for another one. Say of each what is known.

    Args:
        options: Of the command.
        names: The robots.
        failure: What keeps others from being stopped.
    """
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
    others = [] if failure is None else [failed(OTHERS, failure)]
    return show_each(options, [*names, OTHERS], chain(outcomes, others))


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
