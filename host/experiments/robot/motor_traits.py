"""What duties and angles show of a motor with its wheel, and the constants that follow.

Duties and angles alone cannot determine all constants, for no torque is measured: a motor twice as
strong in a robot twice as heavy moves the same. They determine the Traits. The rest is taken from a
published motor.
"""

from __future__ import annotations

from dataclasses import replace
from math import degrees, radians
from typing import NamedTuple

from sim_motor.constants import Constants

# The least moment of inertia of a motor (kg m2). Below it, the published wheel and its share of the
# robot are too heavy.
_LEAST_INERTIA = 1e-5


class Traits(NamedTuple):
    """What duties and angles show of a motor with its wheel, if the battery's voltage is known.

    Attributes:
        speed_per_v: no-load speed for each volt (rad/s/V), with that friction only that grows with
            speed.
        time_constant_s: time (s) in which the speed settles while the motor is shorted. To first
            order, the coil's own time constant L/R shortens it by L/R.
        viscous_part: the share of viscous friction in the damping (1); the rest is the motor as a
            generator.
        static_pct: static friction of gearing and floor together (% duty).
        kinetic_pct: kinetic friction of gearing and floor together (% duty).
        sag: 2 source resistance / resistance (1).
        delay_ms: time (ms) from the tick in which an angle is read until its duty acts, plus L/R;
            the two cannot be separated.
        backlash_deg: backlash (degrees). It shows by the wheel's share of the inertia, which is
            taken from the published motor.
    """

    speed_per_v: float
    time_constant_s: float
    viscous_part: float
    static_pct: float
    kinetic_pct: float
    sag: float
    delay_ms: float
    backlash_deg: float


def traits(constants: Constants, battery_v: float) -> Traits:
    """The traits of a motor with these constants."""
    c = constants
    slope = c.torque_constant / c.resistance  # N m/V
    damping = slope * c.emf_constant + c.viscous
    pct = 100 / (slope * battery_v)
    return Traits(
        speed_per_v=slope / damping,
        time_constant_s=(c.motor_inertia + c.wheel_inertia) / damping - c.inductance / c.resistance,
        viscous_part=c.viscous / damping,
        static_pct=(c.static + c.rolling) * pct,
        kinetic_pct=(c.kinetic + c.rolling) * pct,
        sag=2 * c.source_resistance / c.resistance,
        delay_ms=1000 * (c.latency_s + c.inductance / c.resistance),
        backlash_deg=degrees(c.backlash),
    )


def constants_of(found: Traits, published: Constants, battery_v: float) -> Constants:
    """The constants of a motor with these traits.

    Torque constant, coil and the robot's body, which the traits leave open, are as published.
    """
    p = published
    slope = p.torque_constant / p.resistance
    damping = slope / found.speed_per_v
    newton_metre = slope * battery_v / 100
    return replace(
        p,
        emf_constant=damping * (1 - found.viscous_part) / slope,
        viscous=damping * found.viscous_part,
        motor_inertia=max(
            _LEAST_INERTIA,
            (found.time_constant_s + p.inductance / p.resistance) * damping - p.wheel_inertia,
        ),
        static=max(0.0, found.static_pct * newton_metre - p.rolling),
        kinetic=max(0.0, found.kinetic_pct * newton_metre - p.rolling),
        source_resistance=found.sag * p.resistance / 2,
        latency_s=max(0.0, found.delay_ms / 1000 - p.inductance / p.resistance),
        backlash=radians(found.backlash_deg),
        battery_v=battery_v,
    )
