"""What stands at the end of each command's help: an example, how long it takes, and a page.

Times are those of two idle cores, without what numba compiles once after an installation.
"""

from __future__ import annotations

from typing import NamedTuple

from host.experiments.efforts import EFFORTS, in_words
from host.experiments.registry import BODIES, ROBOT


class Note(NamedTuple):
    """The end of a command's help.

    Attributes:
        example: What may stand behind the command's name.
        takes: How long that takes.
        page: The page of the docs that says more.
    """

    example: str
    takes: str
    page: str


_SHORT = "less than 1 s"
_ROBOTS = "docs/robots.md"
_BRICK = "robot/README.md"
_LOGS = "docs/logs.md"
_EXPERIMENTS = "docs/experiments.md"
_THEORY = "docs/theory.md"
_BODIES = "docs/bodies.md"

NOTES = {
    "demo": Note("--seed 1", "6 s", "docs/claims.md"),
    "kick": Note("--mode phase --ticks 4 --seed 6", "2 s", "docs/first-kick.md"),
    "plan": Note("--to backward", "1 s; with --search 10 to 60 s", _EXPERIMENTS),
    "drive": Note(
        "spin-left --seed 6", "4 s; on a robot in real time 5 to 20 s", "docs/lesson.md"
    ),
    "start": Note("--brick tcp://127.0.0.1:5425", _SHORT, _BRICK),
    "stop": Note("--brick all", _SHORT, _ROBOTS),
    "clear": Note("--brick tcp://127.0.0.1:5425", _SHORT, _BRICK),
    "status": Note("--brick tcp://127.0.0.1:5425", _SHORT, _BRICK),
    "identify": Note("--brick anna", f"{_SHORT}; the robot shows itself for 3 s", _BRICK),
    "params": Note("set k=2 tau_s=1 --brick anna", _SHORT, "docs/model.md"),
    "record": Note(
        "10 --out mine.mcap", "1 s; on a robot in real time as long as it records", _LOGS
    ),
    "watch": Note("--brick anna", "until q or ^C, or --seconds", "docs/listen.md"),
    "lab": Note("--twin", "3 s until the page opens; until ^C", "docs/lab.md"),
    "foxglove": Note("--brick anna", "3 s until it serves; until ^C", "docs/foxglove.md"),
    "log": Note("plot logs/mine.mcap", "2 s; see kickctl log ACTION --help", _LOGS),
    "log list": Note("", _SHORT, _LOGS),
    "log pull": Note("--brick anna --out last.mcap", "2 s", _LOGS),
    "log export": Note("mine.mcap --out mine.csv", _SHORT, _LOGS),
    "log replay": Note("mine.mcap", "1 s for a log of a minute", _LOGS),
    "log plot": Note("mine.mcap --out mine.png", "2 s", _LOGS),
    "log film": Note("mine.mcap --out mine.mp4", "7 s for a log of 10 s", _LOGS),
    "log recover": Note("mine.mcap --out whole.mcap", _SHORT, _LOGS),
    "doctor": Note("--brick anna", "1 s", _BRICK),
    "discover": Note("--save", "4 s", _ROBOTS),
    "robots": Note("add anna ssh://robot@ev3dev.local", _SHORT, _ROBOTS),
    "deploy": Note("robot@ev3dev.local --as anna", "half a minute on a brick", _BRICK),
    "experiment": Note(
        "reliability --quick", "3 s; see kickctl experiment NAME --help", _EXPERIMENTS
    ),
    "theory": Note(
        "hopf --tau 0.3", "2 s; see kickctl theory NAME --help", _THEORY
    ),
    "body": Note("train --time 20", "5 s; longer with --film", _BODIES),
    "rods": Note("--out rods.gif", "4 s", "docs/figures.md"),
    "reproduce": Note("--only R8,M3", "10 minutes for all claims", "docs/claims.md"),
    "help": Note("chaos", _SHORT, "docs/README.md"),
}  # fmt: skip

# An example of each run, and how long the run takes without options.
_RUNS = {
    "experiment primitives": ("--trials 5", "20 s"),
    "experiment timeline": ("--trials 10 --preset paper", "6 s"),
    "experiment reliability": ("--trials 50", "4 s"),
    "experiment kick-map": ("--kicks 20000", "15 s"),
    "experiment bifurcation": ("--points 9", "20 s"),
    "experiment wall": ("--bounces 20", "2 minutes"),
    "experiment chaos": ("--minutes 2", "a minute"),
    "experiment starts": ("--quick", "4 s"),
    "experiment predictions": ("--kicks 100", "15 s"),
    "experiment calibrate": ("--seconds 60", "5 s"),
    "experiment explore": ("--robots 5 --minutes 2", "half a minute"),
    "experiment leave-chaos": ("--robots 20", "half a minute"),
    "experiment exponents": ("--pairs 8", "a minute"),
    "experiment train-start": ("--seeds 5", "20 s"),
    "experiment train-wall": ("--seeds 1 --seconds 20", "a minute"),
    "experiment train-slope": ("--seeds 1", "40 s"),
    "experiment train-wiggle": ("--seconds 20", "a minute"),
    "experiment train-kick": ("--trials 1", "a minute"),
    "experiment train-goal": ("--goals 2", "a minute"),
    "experiment train-fault": ("--seeds 1 --preset paper", "2 minutes"),
    "experiment car-slope": ("--seeds 1 --seconds 60", "a minute"),
    "experiment car-route": ("--seeds 2", "half a minute"),
    "theory fixpoints": ("--k 1.85", "2 s"),
    "theory hopf": ("--tau 0.1:1:10", "2 s"),
    "theory branch": ("--along tau --to 2", "8 s"),
    "theory portrait": ("--k 1.65", "7 s"),
    "theory phase-diagram": ("--points 40", "3 minutes"),
    "theory lines": ("--x tau --y a", "2 minutes"),
    "theory lyapunov": ("--k 8 --tau 1", "8 s"),
    "theory lyapunov-line": ("--k-to 10", "half a minute"),
    "theory lyapunov-plane": ("--k-to 10 --tau-to 1", "a minute"),
    "theory section": ("--k 8 --seconds 100", "4 s"),
    "theory orbit": ("--values 60", "20 s"),
    "theory basins": ("--points 60", "half a minute"),
    "theory edge": ("--k 4", "20 s"),
    "theory escape": ("--noise 0.1", "6 s"),
    "theory tick": ("--tick 0.05", "25 s"),
}


def note_of(command: str) -> str:
    """The lines at the end of a command's help.

    Args:
        command: The command with its program's name, such as 'kickctl log plot'.

    Returns:
        The lines; none for the program itself.
    """
    words = command.partition(" ")[2]
    note = note_on(words)
    if note is None:
        return ""
    typed = f"{command} {note.example}".rstrip()
    lines = f"\nexample:  {typed}\ntakes:    {note.takes}\npage:     {note.page}\n"
    if words.partition(" ")[0] == "theory":
        lines += "words:    kickctl help WORD explains one, such as fold, merging or crisis\n"
    return lines


def note_on(words: str) -> Note | None:
    """The note of a verb, of its action or of a run, such as 'log plot'; None if there is none."""
    return NOTES.get(words) or _note_of_run(words)


def _note_of_run(words: str) -> Note | None:
    """The note of an experiment or study; None if these words are none."""
    if words not in _RUNS:
        return None
    example, takes = _RUNS[words]
    verb, name = words.split()
    takes += " without options"
    if name in EFFORTS:
        defaults = {option.name: option.default for option in ROBOT[name].options}
        takes += f"; on a robot in real time {in_words(EFFORTS[name].seconds(defaults))}"
    simulated = _BODIES if name in BODIES else _EXPERIMENTS
    return Note(example, takes, _THEORY if verb == "theory" else simulated)
