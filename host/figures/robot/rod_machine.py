"""A drawing of a wheel with its transmission rods that can be moved, for films."""

from __future__ import annotations

from math import cos, sin
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from host.figures.style import COLOURS

Array = NDArray[np.float64]

KICK = COLOURS[1]
# How far from the wheel's axle the rods end, and how far beside them the springs lie.
_LONG, _ASIDE = 2.9, 0.42
_ROD, _WHEEL = "dimgrey", "#e8e8e8"
_ACTUAL, _TARGET = COLOURS[4], COLOURS[2]
_RING: Any = {"markerfacecolor": "none", "markeredgecolor": KICK, "markeredgewidth": 2.5}
_COILS = 7


class RodMachine:
    """A wheel with two rods, the first along x, the second along y.

    A spring pulls each rod's head to its target.
    """

    def __init__(self, axes: Axes) -> None:
        axes.set_aspect("equal")
        axes.set_axis_off()
        axes.set_xlim(-1.35, 4.25)
        axes.set_ylim(-4.25, 1.35)
        turn = np.linspace(0.0, 2 * np.pi, 121)
        axes.fill(np.cos(turn), np.sin(turn), facecolor=_WHEEL, edgecolor="black", linewidth=2.5)
        axes.plot(0, 0, "o", color="black", markersize=6)
        (self._spoke,) = axes.plot([], [], color="darkgrey", linewidth=2)
        bar: Any = {"linewidth": 5, "solid_capstyle": "round"}
        self._rods = [axes.plot([], [], color=_ROD, **bar)[0] for _ in range(2)]
        self._springs = [axes.plot([], [], color="black", linewidth=1.2)[0] for _ in range(2)]
        self._targets = [axes.plot([], [], color=_TARGET, **bar)[0] for _ in range(2)]
        self._heads = [axes.plot([], [], color=_ACTUAL, **bar)[0] for _ in range(2)]
        (self._pin,) = axes.plot([], [], "o", color=_ACTUAL, markersize=11, markeredgecolor="black")
        (self._seen,) = axes.plot([], [], "o", markersize=15, **_RING)
        # From the backmost to the foremost.
        self.moving = (
            self._spoke,
            *self._rods,
            *self._springs,
            *self._targets,
            *self._heads,
            self._pin,
            self._seen,
        )
        for number, at in enumerate((-1.0, 0.0, 1.0)):
            for rod in range(2):
                axes.plot(
                    *_place(rod, [at, at], [2 * _ASIDE + 0.05, 2 * _ASIDE + 0.17]),
                    color="grey",
                    linewidth=1.2,
                )
                text: Any = {"ha": "center", "va": "center", "fontsize": 11, "color": "dimgrey"}
                (x,), (y,) = _place(rod, [at], [2 * _ASIDE + 0.36])
                axes.text(float(x), float(y), f"{number - 1}", **text)
        for rod in range(2):
            axes.plot(
                *_place(rod, [-1.0, 1.0], [2 * _ASIDE + 0.05] * 2), color="grey", linewidth=1.2
            )

    def show(self, phi: float, actual: Array, targets: Array, seen: Array) -> None:
        """Draw it as it is at one time.

        Args:
            phi: the wheel's angle (rad).
            actual: the rods' actual positions, (2,).
            targets: their target positions, (2,).
            seen: the positions that a kick shows to the neurons, (2,); NaN if none does.
        """
        pin = cos(phi), sin(phi)
        self._pin.set_data([pin[0]], [pin[1]])
        self._spoke.set_data([0.0, pin[0]], [0.0, pin[1]])
        self._seen.set_data([seen[0]], [seen[1]])
        for rod in range(2):
            at, target = float(actual[rod]), float(targets[rod])
            head = _place(rod, [at], [0.0])
            self._rods[rod].set_data([pin[0], head[0][0]], [pin[1], head[1][0]])
            self._heads[rod].set_data(*_place(rod, [at, at], [0.0, 1.45 * _ASIDE]))
            self._targets[rod].set_data(
                *_place(rod, [target, target], [0.55 * _ASIDE, 1.9 * _ASIDE])
            )
            self._springs[rod].set_data(*_place(rod, *_spring(at, target)))


def _place(rod: int, along: Any, aside: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points beside the rail of a rod's head: right of the wheel for rod 0, below it for rod 1."""
    on, off = np.asarray(along, dtype=float), np.asarray(aside, dtype=float)
    return (_LONG + on, -off) if rod == 0 else (off, on - _LONG)


def _spring(begin: float, end: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A coil from begin to end."""
    along = np.linspace(begin, end, 2 * _COILS + 1)
    aside = np.full(len(along), _ASIDE)
    aside[1:-1] += 0.11 * np.resize([1, -1], len(along) - 2)
    return along, aside


def explain(axes: Axes) -> None:
    """What is what, where the picture is empty."""
    lines = (
        (Line2D([], [], color=_ROD, linewidth=5), "transmission rod"),
        (Line2D([], [], color=_ACTUAL, linewidth=5), r"actual position $x_i^{(\mathrm{a})}$"),
        (Line2D([], [], color=_TARGET, linewidth=5), r"target position $x_i^{(\mathrm{t})}$"),
        (
            Line2D([], [], color="black", linewidth=1.2),
            r"spring, $F_i = k\,(x_i^{(\mathrm{t})} - x_i^{(\mathrm{a})})$",
        ),
        (
            Line2D([], [], marker="o", linestyle="", markersize=12, **_RING),
            "what the kick shows\nthe neurons",
        ),
    )
    style: Any = {
        "loc": "center",
        "bbox_to_anchor": (0.74, 0.24),
        "fontsize": 12,
        "handlelength": 1.4,
        "labelspacing": 0.7,
    }
    axes.legend(*zip(*lines, strict=True), **style)
