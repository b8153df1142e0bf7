"""The equations of one tick with their numbers: what the page shows at the cursor of a replay.

The robot's own functions compute every number. What stands here as text is for people; the page
puts the numbers into it, and typesets the minus signs.
"""

from __future__ import annotations

import re
import struct
from math import nan
from typing import Any, NamedTuple

from robot.controller import (
    actual_positions,
    lagging_angle,
    membrane_rate,
    motor_torque,
    rod_force,
    tangential_force,
    target_position,
)
from robot.kicks import Kick, apply_kick, seen_positions
from robot.record import NAMES, Record, channel, of_each_wheel
from robot.safety import limit_duty
from robot.wheel import Wheel

# How a recomputed tick compares with the logged one.
NOT_COMPARABLE, SAME, ROUNDED, OTHER = range(4)
_WHEEL = (
    channel("was1", "d", "1", "first potential before this tick"),
    channel("was2", "d", "1", "second potential before this tick"),
    channel("from1", "d", "1", "first potential after a kick, from which the neuron steps"),
    channel("from2", "d", "1", "second potential after a kick, from which the neuron steps"),
    channel("beta", "d", "1", "how far a kick inverts the seen positions"),
    channel("shift_rad", "d", "rad", "by which angle a kick shifts the seen positions"),
    channel("a", "d", "1", "gain in force in this tick"),
    channel("tau_s", "d", "s", "time constant in force in this tick"),
    channel("k", "d", "1", "spring constant in force in this tick"),
    channel("actual1", "d", "1", "actual position of the first rod"),
    channel("actual2", "d", "1", "actual position of the second rod"),
    channel("rod1", "d", "1", "position of the first rod in its force"),
    channel("rod2", "d", "1", "position of the second rod in its force"),
    channel("seen1", "d", "1", "position that the first neuron sees"),
    channel("seen2", "d", "1", "position that the second neuron sees"),
    channel("rate1", "d", "1/s", "rate of the first potential"),
    channel("rate2", "d", "1/s", "rate of the second potential"),
    channel("x1", "d", "1", "first potential after the step, recomputed"),
    channel("x2", "d", "1", "second potential after the step, recomputed"),
    channel("target1", "d", "1", "target position of the first rod"),
    channel("target2", "d", "1", "target position of the second rod"),
    channel("force1", "d", "1", "force on the first rod"),
    channel("force2", "d", "1", "force on the second rod"),
    channel("force", "d", "1", "F_tan, recomputed"),
    channel("torque", "d", "1", "M, recomputed"),
    channel("duty_scale", "d", "1", "the parameter of this name in this tick"),
    channel("max_duty_pct", "d", "%", "the parameter of this name in this tick"),
    channel("duty_pct", "d", "%", "duty cycle, recomputed from the logged torque"),
    channel("jumped1", "B", "1", "1 if a kick makes the first potential jump in this tick"),
    channel("jumped2", "B", "1", "1 if a kick makes the second potential jump in this tick"),
    channel("shifted", "B", "1", "1 if a kick changes the seen positions in this tick"),
    channel("rods", "B", "1", "1 if both rods exist"),
)
CHANNELS = (
    channel("compared", "B", "1", "0 not comparable, 1 the same bits, 2 rounded, 3 different"),
    *of_each_wheel(_WHEEL, "_eq_"),
)
STRUCT = struct.Struct("<" + "".join(row.code for row in CHANNELS))
# A wheel's numbers in a tick in which no equation acts.
OFF: tuple[float, ...] = tuple(nan if row.code == "d" else 0 for row in _WHEEL)


# The sign of a line that computes a new value of a quantity from its old one.
NEW = "←"


class Line(NamedTuple):
    """One line of the working, for one wheel.

    symbol: what is computed. formula: how, in symbols. numbers: the same, with the names of the
    channels in braces. result: the channel with its value. logged: the robot's own channel that
    must hold the same value, or empty. when: the channel that is 1 in ticks with this line, or
    empty for all. unit: of the value; '1' for none. sign: what stands between symbol and formula.
    joint: what stands between numbers and result.
    """

    symbol: str
    formula: str
    numbers: str
    result: str
    logged: str = ""
    when: str = ""
    unit: str = "1"
    sign: str = "="
    joint: str = "="


_LINES = (
    Line("x₁ᵃ", "cos φ", "cos({phi_rad})", "actual1"),
    Line("x₂ᵃ", "sin φ", "sin({phi_rad})", "actual2"),
    Line(
        "x₁ˢ", "(1 - 2β) cos(φ + δ)",
        "(1 - 2 · {beta}) · cos({phi_rad} + {shift_rad})", "seen1", when="shifted",
    ),
    Line(
        "x₂ˢ", "(1 - 2β) sin(φ + δ)",
        "(1 - 2 · {beta}) · sin({phi_rad} + {shift_rad})", "seen2", when="shifted",
    ),
    Line("x₁", "jump by the kick", "from {was1}", "from1", when="jumped1", sign=NEW, joint="to"),
    Line("x₂", "jump by the kick", "from {was2}", "from2", when="jumped2", sign=NEW, joint="to"),
    Line("dx₁/dt", "(x₁ˢ - x₁) / τ", "({seen1} - {from1}) / {tau_s}", "rate1"),
    Line("dx₂/dt", "(x₂ˢ - x₂) / τ", "({seen2} - {from2}) / {tau_s}", "rate2"),
    Line("x₁", "x₁ + Δt dx₁/dt", "{from1} + {dt_s} · {rate1}", "x1", "x1", sign=NEW),
    Line("x₂", "x₂ + Δt dx₂/dt", "{from2} + {dt_s} · {rate2}", "x2", "x2", sign=NEW),
    Line("x₁ᵗ", "2 / (1 + exp(-a x₁)) - 1", "2 / (1 + exp(-{a} · {x1})) - 1", "target1"),
    Line(
        "x₂ᵗ", "2 / (1 + exp(-a x₂)) - 1",
        "2 / (1 + exp(-{a} · {x2})) - 1", "target2", when="rods",
    ),
    Line("F₁", "k (x₁ᵗ - x₁ᵃ)", "{k} · ({target1} - {rod1})", "force1"),
    Line("F₂", "k (x₂ᵗ - x₂ᵃ)", "{k} · ({target2} - {rod2})", "force2", when="rods"),
    Line(
        "F_tan", "F₁ sin φ - F₂ cos φ",
        "{force1} · {actual2} - {force2} · {actual1}", "force", "force",
    ),
    Line("M", "tanh F_tan", "tanh({force})", "torque", "torque"),
    Line(
        "duty", "M in %, scaled, limited, rounded", "{max_duty_pct} · {duty_scale} · {torque}",
        "duty_pct", "duty_pct", unit="%",
    ),
)  # fmt: skip


def lines_of(side: str) -> list[dict[str, str]]:
    """The lines of the working of a wheel as plain data, with the full names of channels.

    Args:
        side: 'left' or 'right'.

    Returns:
        One dictionary with the fields of `Line` for each line.
    """
    own = {row.name for row in _WHEEL}

    def full(name: str) -> str:
        if name in own:
            return f"{side}_eq_{name}"
        return name if name in NAMES else f"{side}_{name}"

    def data(line: Line) -> dict[str, str]:
        numbers = re.sub(r"\{(\w+)\}", lambda found: f"{{{full(found[1])}}}", line.numbers)
        names = {
            "result": full(line.result),
            "logged": line.logged and f"{side}_{line.logged}",
            "when": line.when and full(line.when),
        }
        return line._replace(numbers=numbers, **names)._asdict()

    return [data(line) for line in _LINES]


class Before(NamedTuple):
    """A wheel's state before a tick: potentials (1), and the angle before (rad) or None."""

    x1: float
    x2: float
    phi_before: float | None

    @classmethod
    def of(cls, wheel: Wheel) -> Before:
        """The state of a wheel, to be kept while the wheel steps."""
        return cls(wheel.x1, wheel.x2, wheel.phi_before)


def work_out(
    wheel: Wheel, before: Before | None, record: Record, params: Any, kick: Kick | None
) -> tuple[float, ...]:
    """The numbers of a wheel's equations in one tick in which the robot runs.

    Args:
        wheel: The wheel after the tick, as the replay has computed it.
        before: Its state before the tick; None if the log does not say it.
        record: The tick as logged.
        params: The robot.params.Params in force.
        kick: The robot's kick, which may be over; None if there is none.

    Returns:
        One number for each channel of a wheel, NaN where it is not known.
    """
    phi_rad, dt_s = getattr(record, wheel.side + "_phi_rad"), record.dt_s
    x1, x2, phi_before = before or Before(nan, nan, nan)
    was1, was2, a, tau_s, k, beta, shift_rad = x1, x2, params.a, params.tau_s, params.k, 0.0, 0.0
    actual = rod = seen = actual_positions(phi_rad)
    if params.rod_lag_s and phi_before is not None:
        rod = actual_positions(lagging_angle(phi_rad, phi_before, dt_s, params.rod_lag_s))
    if kick is not None and wheel.side in kick.wheels:
        acting = kick.numbers(wheel.index)
        x1, x2, a, tau_s, k, beta, shift_rad = apply_kick(acting, record.tick, x1, x2, a, tau_s, k)
        seen = seen_positions(phi_rad, beta, shift_rad)
    if before is None:
        x1 = x2 = nan
    targets = target_position(wheel.x1, a), target_position(wheel.x2, a)
    force1 = rod_force(targets[0], rod[0], k)
    force2 = rod_force(targets[1], rod[1], k) if params.rods == 2 else 0.0
    force = tangential_force(force1, force2, *actual)
    torque = getattr(record, wheel.side + "_torque")
    numbers: tuple[float, ...] = (
        *(was1, was2, x1, x2, beta, shift_rad, a, tau_s, k, *actual, *rod, *seen),
        *(membrane_rate(x1, seen[0], tau_s), membrane_rate(x2, seen[1], tau_s)),
        *(wheel.x1, wheel.x2, *targets, force1, force2, force, motor_torque(force)),
        *(params.duty_scale, params.max_duty_pct),
        limit_duty(params.duty_scale * torque, params.max_duty_pct),
        x1 != was1 and before is not None,
        x2 != was2 and before is not None,
        bool(beta or shift_rad),
        params.rods == 2,
    )
    return numbers
