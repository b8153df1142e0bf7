"""The paper's controller: two neurons and two simulated transmission rods for each wheel.

Equations are numbered by their labels in Sandor et al., Front. Neurorobot. 12:40 (2018). Every
function is pure, takes and returns floats, uses nothing but `math`, and compiles unchanged under
numba. This is the only place where they are written down.

Units: angles in rad, times in s; membrane potentials, positions, forces and torques are
dimensionless, as in the paper.
"""

from math import cos, exp, sin, tanh


def actual_positions(phi):
    """(x1_a, x2_a) = (cos phi, sin phi): the rods' actual positions at wheel angle phi. Eq.

    actual_pos.
    """
    return cos(phi), sin(phi)


def target_position(x, a):
    """x_t = 2 y(x) - 1 in (-1, 1): where a neuron of potential x and gain a wants its rod.

    Its rate is y = 1 / (1 + exp(-a x)).

    Eq. target_pos.
    """
    return 2.0 / (1.0 + exp(-a * x)) - 1.0


def rod_force(x_target, x_actual, k):
    """F_i = k (x_t - x_a): the spring of constant k that pulls a rod to its target. Eq. F_i."""
    return k * (x_target - x_actual)


def membrane_rate(x, x_seen, tau_s):
    """dx/dt = (x_seen - x) / tau in 1/s.

    A membrane potential follows the position its neuron sees. Eq. dot_x.
    """
    return (x_seen - x) / tau_s


def tangential_force(force_1, force_2, actual_1, actual_2):
    """F_tan = F_1 sin phi - F_2 cos phi.

    What two perpendicular rods do together at the wheel's rim. Eq. F_tan.

    (actual_1, actual_2) = (cos phi, sin phi) are the rods' actual positions.
    """
    return force_1 * actual_2 - force_2 * actual_1


def motor_torque(force):
    """M = tanh(F_tan) in (-1, 1): the torque relative to the motor's maximum. Eq. torque."""
    return tanh(force)


def step_wheel(x1, x2, actual_1, actual_2, seen_1, seen_2, dt_s, a, tau_s, k, rods):
    """One tick of one wheel: (x1, x2, force, torque) after an Euler step of dt_s.

    The neurons step first, on the positions they see (seen_1, seen_2; a kick may have altered
    these), and the rods act on the new potentials. The rods' forces are projected at the true angle
    phi, kicked or not. With rods = 1 only the first rod exists.
    """
    x1 += dt_s * membrane_rate(x1, seen_1, tau_s)
    x2 += dt_s * membrane_rate(x2, seen_2, tau_s)
    force_1 = rod_force(target_position(x1, a), actual_1, k)
    force_2 = rod_force(target_position(x2, a), actual_2, k) if rods == 2 else 0.0
    force = tangential_force(force_1, force_2, actual_1, actual_2)
    return x1, x2, force, motor_torque(force)
