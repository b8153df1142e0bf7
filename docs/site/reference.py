"""The pages of reference, each made from the table that the program itself uses."""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from types import MethodType, ModuleType, SimpleNamespace

import kickctl
import kickctl.theory
from docs.site.command_line import pages as command_line
from docs.site.markdown import table, toctree
from robot.params import TABLE
from robot.record import CHANNELS
from tests.faults.rows import ROWS

FOLDER = "reference/"
_INDEX = """\
Each page here is made from the program's own tables, so that it says what this release does.
`kickctl help WORD` searches them in a terminal. Each [experiment](experiment.md) and each [study of
the model](theory.md) has a page, with the columns of its tables.
"""
_PARAMETERS = """\
`kickctl params list` shows those of a robot, `kickctl params set NAME=VALUE` changes one while it
runs, and `--set NAME=VALUE` gives one to the robot that is simulated without `--brick`.
"""
_CHANNELS = """\
The robot records these in every tick. `log.column(NAME)` in Python gives one as an array.
`kickctl log export` writes them as columns, `kick` and `state` in words, and adds the wheels'
speeds, `left_omega_rad_s` and `right_omega_rad_s`; [logs](../docs/logs.md) says more.
"""
_FAULTS = """\
What a robot says when something goes wrong, what to do then, and how long its motors may run on.
`make faults` causes each of them many times, and measures.
[When it does not move](../robot/README.md#when-it-does-not-move) has more of them.
"""
_RESTART = "`kickctl deploy`, which starts the program again"
_CLEAR = "`kickctl clear`, `kickctl start`"
_BACK = "bring the link back: the host finds the robot again"
# What to do about each row of the table.
_REMEDIES = {
    "SIGKILL of the loop": _RESTART,
    "SIGSEGV of the loop": f"{_RESTART}; please report it",
    "SIGSTOP of the loop": f"end what holds the program up, then {_CLEAR}",
    "hang in the loop": f"{_RESTART}; please report it",
    "crash in Python": f"{_RESTART}; please report it",
    "watchdog killed": _RESTART,
    "watchdog frozen": _RESTART,
    "link cut, policy stop": f"{_BACK}, then `kickctl start`",
    "link cut, policy hold": _BACK,
    "link cut, policy continue": _BACK,
    "host killed": "start a host; if the robot has stopped, `kickctl start`",
    "stop frame of a stranger": "ask who has stopped it, then `kickctl start`",
    "cable out": f"plug it in, wait a second, {_CLEAR}",
    "cable back, then clear": "nothing: this is the way back",
    "permission race after replug": "wait a second, and clear again",
    "EIO once": _CLEAR,
    "EIO six times": f"check the motor's cable, then {_CLEAR}",
    "battery empty": "charge or change it, then `kickctl start`; there is no fault to clear",
    "disk of the host full": "make room on this computer's disk, and record again",
    "clock jump": "nothing",
}
# What Python's own classes give to all of theirs says nothing about these.
_MEMBERS = "   :members:\n   :inherited-members: BaseException, Mapping, tuple\n"


def pages() -> dict[str, str]:
    """All of them, by their paths."""
    made = {
        FOLDER + "python.md": _python(kickctl),
        FOLDER + "python-theory.md": _python(kickctl.theory),
        FOLDER + "parameters.md": _parameters(),
        FOLDER + "channels.md": _channels(),
        FOLDER + "faults.md": _faults(),
    }
    commands, inner = command_line(FOLDER)
    index = f"# Reference\n\n{_INDEX}{toctree([*commands, *made], hidden=False)}"
    return {FOLDER + "index.md": index, **made, **commands, **inner}


def _python(module: ModuleType) -> str:
    parts = [f"# {module.__name__} in Python\n\n{inspect.getdoc(module)}\n"]
    for name in module.__all__:
        thing = getattr(module, name)
        what = f"autofunction:: {module.__name__}.{name}\n"
        if isinstance(thing, type):
            kind = "exception" if issubclass(thing, Exception) else "class"
            what = f"auto{kind}:: {module.__name__}.{name}\n{_MEMBERS}"
        elif inspect.ismethod(thing):
            what = f"autofunction:: {module.__name__}.{name}{_arguments(thing)}\n"
        parts.append(f"## {name}\n\n```{{eval-rst}}\n.. {what}```\n")
    return "\n".join(parts)


def _arguments(method: MethodType) -> inspect.Signature:
    """Its arguments as they are called; Sphinx would leave out the first one."""
    bound = inspect.signature(method)
    empty = inspect.Parameter.empty
    return bound.replace(
        parameters=[one.replace(annotation=empty) for one in bound.parameters.values()],
        return_annotation=empty,
    )


def _parameters() -> str:
    parts = "\n".join(f"## `{row.name}`\n\n{_parameter(row)}\n" for row in TABLE.values())
    return f"# The robot's parameters\n\n{_PARAMETERS}\n{parts}"


def _parameter(row: SimpleNamespace) -> str:
    unit = "" if row.unit in ("", "1") else " " + row.unit
    allowed = (
        " or ".join(f"`{choice}`" for choice in row.choices)
        if row.choices
        else f"{row.minimum:g} to {row.maximum:g}{unit}"
    )
    rest = " Changes only while the robot stands still." if row.at_rest_only else ""
    return (
        f"{_sentence(row.doc)}\n\n{allowed[0].upper()}{allowed[1:]}; default"
        f" {row.default}{unit}.{rest}"
    )


def _channels() -> str:
    rows = [(f"`{row.name}`", row.unit, row.doc) for row in CHANNELS]
    return f"# The columns of a log\n\n{_CHANNELS}\n{table(('column', 'unit', 'meaning'), rows)}"


def _faults() -> str:
    rows: Sequence[Sequence[str]] = [
        (
            f"... {row.words} ..." if row.words else "nothing",
            _REMEDIES[row.name],
            "they go on" if row.limit_s is None else f"{row.limit_s:g} s",
            row.name,
        )
        for row in ROWS
    ]
    head = ("the robot says", "what to do", "motors stop within", "what causes it in the tests")
    return f"# Faults\n\n{_FAULTS}\n{table(head, rows)}"


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}."
