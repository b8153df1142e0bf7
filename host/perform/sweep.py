"""An experiment or study at each point of a sweep, as one run: its cells are those of all points.

A point computes the same numbers as a run of its own with the same options and seed. If it fails,
the table says why, and the sweep goes on.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

from host.client.robot import Robot
from host.errors import KickctlError, NotDone, RobotFault, WrongUse
from host.logs.log import Log
from host.logs.mcap_files import LogError
from host.perform.catalogue import find
from host.runs.answers import Answer
from host.runs.columns import Column, Kind, columns_of
from host.runs.contract import OWN, POINT, Cell, Findings, Options, Part, Parts, Row, Setting
from host.runs.runner import Outcome, Work
from host.runs.sweep import (
    Axis,
    Numbers,
    Point,
    Quantity,
    extremes,
    failure,
    place,
    points,
    quantities,
)

# How a point may fail: it makes no sense, the robot does not do it, or its numbers overflow.
FAILURES = (WrongUse, NotDone, RobotFault, ArithmeticError, ValueError)
# The keys of a row of a cell, and of a point that has none.
_ROW, _FAILED = "row", "failed"


class Sweep:
    """The experiment `name` at each point of a sweep. It is an Experiment.

    Args:
        name: The experiment's name.
        swept: The options that have several values.
    """

    def __init__(self, name: str, swept: list[Axis]) -> None:
        self._name, self._found = name, find(name)
        self._work = self._found.work
        self._swept = swept
        self.simulate: Callable[[Cell, Setting], list[Row]] | None = (
            None if self._work.simulate is None else partial(_simulate, name)
        )

    @property
    def kinds(self) -> list[Kind]:
        """The one kind of rows of the sweep's table."""
        swept = [
            Column(axis["name"], axis["unit"], "an option that is swept") for axis in self._swept
        ]
        columns = (*swept, *columns_of(Quantity))
        names = frozenset(column.name for column in columns)
        return [Kind("", "A quantity at a point.", columns, names)]

    @property
    def parts(self) -> Parts | None:
        """Computes a cell part by part; None if the experiment's cells are short."""
        return None if self._found.parts is None else partial(_parts, self._found.parts)

    def cells(self, options: Options, *, batch: bool) -> list[Cell]:
        """The cells of all points. Raises WrongUse, of the first point, if no point has any."""
        found: list[Cell] = []
        refusals: list[KickctlError] = []
        for point in points(self._swept):
            try:
                own = self._found.cells({**options, **point}, batch=batch)
                found += [{POINT: point, OWN: cell} for cell in own]
            except WrongUse as error:
                refusals.append(error)
                found.append({POINT: point, _FAILED: _reason(error)})
        if len(refusals) == len(found):
            raise refusals[0]
        return found

    def world(self, cell: Cell) -> dict[str, str]:
        """What surrounds the robot in this cell."""
        return self._work.world(cell[OWN])

    def trial(self, cell: Cell, robot: Robot, log: Log, setting: Setting) -> list[Row]:
        """Do one cell on a robot."""
        rows = self._work.trial(cell[OWN], robot, log, setting.at(cell))
        return [{_ROW: row} for row in rows]

    def table(self, rows: list[Row], setting: Setting) -> list[Row]:
        """A row for each point and quantity. A point that failed has one row, which says why."""
        by_point: dict[tuple[float, ...], list[Row]] = {}
        for row in rows:
            by_point.setdefault(tuple(row[POINT].values()), []).append(row)
        return [
            {**point, **quantity}
            for point in points(self._swept)
            for quantity in self._quantities(point, by_point[tuple(point.values())], setting)
        ]

    def _quantities(self, point: Point, rows: list[Row], setting: Setting) -> list[Quantity]:
        for row in rows:
            if _FAILED in row:
                return [failure(row[_FAILED])]
        try:
            own = [{**row[OWN], **row[_ROW]} for row in rows]
            return quantities(self._work.report(own, setting.at({POINT: point})), point)
        except FAILURES as error:
            return [failure(_reason(error))]

    def report(self, rows: list[Row], setting: Setting) -> Findings:
        """The findings from the table: its rows, and where each quantity is extreme. No claims."""
        answers = extremes(rows, self._swept)
        failed = [row for row in rows if row["failed"]]
        if failed:
            first = f"at {place(failed[0], self._swept)}: {failed[0]['failed']}"
            answers.append(Answer("points that failed", f"{len(failed)}, the first {first}"))
        names = [axis["name"] for axis in self._swept]
        numbers: Numbers = {
            "of": self._name,
            "swept": self._swept,
            "constants": {
                name: value for name, value in setting.options.items() if name not in names
            },
            "rows": rows,
        }
        return Findings([], numbers, answers=answers)


def _simulate(name: str, cell: Cell, setting: Setting) -> list[Row]:
    """Compute one cell of the experiment at its point."""

    def compute(cell: Cell) -> Outcome:
        simulate = find(name).work.simulate
        assert simulate is not None
        return [{_ROW: row} for row in simulate(cell[OWN], setting.at(cell))], []

    return forgiving(compute)(cell)[0]


def _parts(parts: Parts, cell: Cell, setting: Setting, begun: Part | None) -> Iterator[Part]:
    """Compute one cell of the experiment at its point, part by part."""
    if _FAILED in cell:
        yield Part([{}])
        return
    own = begun and begun._replace(rows=[row[_ROW] for row in begun.rows])
    try:
        for part in parts(cell[OWN], setting.at(cell), own):
            yield part._replace(rows=[{_ROW: row} for row in part.rows])
    except FAILURES as error:
        yield Part([{_FAILED: _reason(error)}])


def forgiving(work: Work, failures: tuple[type[Exception], ...] = FAILURES) -> Work:
    """The same work, for which a cell that fails in one of these ways is a row that says why."""

    def attempt(cell: Cell) -> Outcome:
        if _FAILED in cell:
            return [{}], []  # its row has the cell's reason
        try:
            return work(cell)
        except LogError:
            raise  # its log cannot be written here and now, which says nothing about the point
        except failures as error:
            return [{_FAILED: _reason(error)}], []

    return attempt


def _reason(error: Exception) -> str:
    """Why a point failed, in words."""
    if isinstance(error, KickctlError):
        return "; ".join(filter(None, (error.message, error.hint)))
    return f"{type(error).__name__}: {error}"
