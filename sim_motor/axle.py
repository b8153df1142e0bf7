"""The cross axle between a motor and its wheel, which twists: a damped spring at the wheel's rim.

A long axle is so soft that a blocked wheel's motor springs back on it. The rim has next to no mass
of its own, so that axle and tread, one behind the other, bear the same force.
"""

from math import inf

from sim_motor.constants import SUBSTEP_S, data


def axle_stiffness(free_length: float, shear_modulus: float) -> float:
    """The stiffness of an axle against a force at the rim of its wheel.

    A torque T twists a shaft by the angle T L / (G J). A force F at the rim is the torque F r, and
    the rim moves by r times the angle.

    Args:
        free_length: L, between the motor's hub and the wheel's, m.
        shear_modulus: G, of the axle's plastic, Pa.

    Returns:
        F over the way of the rim, G J / (L r^2), N/m.
    """
    robot = data()["robot"]
    torsion_constant, radius = robot["axle_torsion_constant"][0], robot["wheel_radius"][0]
    stiffness: float = shear_modulus * torsion_constant / (free_length * radius**2)
    return stiffness


def stiffness_range() -> tuple[float, float]:
    """The least and the greatest stiffness that an axle may have, N/m: all that is known of it."""
    robot = data()["robot"]
    softest = robot["axle_length_most"][0], robot["axle_shear_modulus_least"][0]
    stiffest = robot["axle_length_least"][0], robot["axle_shear_modulus_most"][0]
    return axle_stiffness(*softest), axle_stiffness(*stiffest)


def twist_speed(
    twist: float,
    stretch: float,
    slip: float,
    tread: tuple[float, float],
    axle: tuple[float, float],
) -> float:
    """How fast an axle twists while the tread holds, m/s at the rim.

    It is the speed at which axle and tread bear the same force at the end of the substep.

    Args:
        twist: How far the motor is ahead of the rim, m.
        stretch: How far the tread is stretched forward, m.
        slip: Speed of the rim over the floor backward if the axle were rigid, m/s.
        tread: Stiffness and damping of the tread, N/m and N s/m.
        axle: Those of the axle; the stiffness is inf for a rigid one.
    """
    if axle[0] == inf:
        return 0.0
    of_axle = axle[0] * SUBSTEP_S + axle[1]
    of_tread = tread[0] * SUBSTEP_S + tread[1]
    return (tread[0] * stretch - axle[0] * twist + of_tread * slip) / (of_axle + of_tread)


def next_stretch(stretch: float, force: float, spring: tuple[float, float]) -> float:
    """How far a damped spring is stretched a substep later under a force.

    Args:
        stretch: How far it is now, m.
        force: In N, during the substep.
        spring: Its stiffness (N/m; inf for a rigid one, which does not stretch) and its damping
            (N s/m).
    """
    return (spring[1] * stretch + SUBSTEP_S * force) / (spring[1] + spring[0] * SUBSTEP_S)
