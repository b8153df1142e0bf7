"""Robots and logs as widgets of a notebook, drawn by the very modules of the lab's page.

A notebook takes a widget's program as one text. This one holds the page's modules as they are, and
loads them by their texts.
"""

from __future__ import annotations

import json
from hashlib import sha256
from typing import Any

import anywidget
import traitlets
from IPython import get_ipython
from IPython.display import display

from host.client.watching import Watcher
from host.errors import WrongUse
from host.lab.page_files import page_modules, page_text
from host.lab.shown_robot import ShownRobot
from host.lab.tape import MOST_TICKS, Cut, make_tape
from host.logs.log import Log
from host.logs.mcap_files import LogError


def program(first: str) -> str:
    """A widget's program: the page's module `first`, and all that it imports."""
    texts = json.dumps(page_modules(first), allow_nan=False)
    digest = sha256(texts.encode()).hexdigest()
    return (
        f"{page_text('from_texts.js')}\n"
        f"const texts = {texts};\n"
        f'export default async () => (await load(texts, "{first}", "{digest}")).default();\n'
    )


# By nesting, the rules that the page has, too, hold within a widget only.
STYLES = f".kickctl {{\n{page_text('parts.css')}}}\n{page_text('notebook.css')}"


class RobotWidget(anywidget.AnyWidget):
    """A robot as it moves.

    Args:
        robot: A connection to it.
    """

    _esm = program("notebook_robot.js")
    _css = STYLES

    def __init__(self, robot: Watcher) -> None:
        super().__init__()
        # A page's message goes to the subshell that it names. Otherwise ipykernel gives it to the
        # one that has sent the last news, which may be the cells' own: a stop would wait there.
        self.comm._reply_subshell_for = None  # noqa: SLF001
        try:
            self.shown = ShownRobot(robot, self.send, self.close)
        except BaseException:
            self.close()
            raise
        self.on_msg(lambda _, message, buffers: self.shown.take(message))
        self.shown.begin()


class LogWidget(anywidget.AnyWidget):
    """A log with a slider.

    Args:
        tape: As host.lab.tape.make_tape returns it.
    """

    _esm = program("notebook_log.js")
    _css = STYLES
    tape = traitlets.Dict().tag(sync=True)

    def __init__(self, tape: dict[str, Any]) -> None:
        super().__init__(tape=tape)
        self.on_msg(lambda _, message, buffers: self.close())  # nobody looks any more


def show_robot(robot: Watcher) -> None:
    """Show a robot in the notebook's present cell. Raises KickctlError."""
    _need_notebook("`kickctl lab` shows a robot in a browser, `kickctl watch` in a terminal")
    display(RobotWidget(robot))


def show_log(log: Log, cut: Cut) -> None:
    """Show a part of a log in the notebook's present cell. Raises WrongUse."""
    _need_notebook("log.save(FILE), and `kickctl lab --replay FILE` shows it in a browser")
    if not len(log):
        raise WrongUse("this log is empty", "robot.record(3) records three seconds")
    if cut.from_s > cut.to_s:
        raise WrongUse(
            f"from_s={cut.from_s:g} is later than to_s={cut.to_s:g}",
            "exchange them: both count from the log's start",
        )
    name = str(log.info.get("robot") or log.info.get("brick") or "log")
    try:
        tape = make_tape(log, name, cut)
    except LogError:
        raise
    except WrongUse as error:
        raise WrongUse(
            error.message,
            f"it lasts {log.seconds:.1f} s, and up to {MOST_TICKS:,} ticks can be shown at once:"
            " log.show(from_s=0, to_s=300) takes the first five minutes",
        ) from error
    display(LogWidget(tape))


def _need_notebook(instead: str) -> None:
    if getattr(get_ipython(), "kernel", None) is None:
        raise WrongUse("show() draws in a notebook, and this program runs in none", instead)
