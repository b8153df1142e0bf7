"""The paper's controller: two neurons and two simulated transmission rods for each wheel.

In every control period, `step_wheel` takes a wheel from its angle phi to a torque M:

    dx_i/dt = (x_i_seen - x_i) / tau          the neurons follow the rods' positions
    x_i_t   = 2 / (1 + exp(-a x_i)) - 1       and want the rods elsewhere,
    F_i     = k (x_i_t - x_i_a)               to where simulated springs pull them;
    F_tan   = F_1 sin phi - F_2 cos phi       that turns the wheel
    M       = tanh(F_tan)                     with a bounded torque.

Here (x_1_a, x_2_a) = (cos phi, sin phi), and a kick may change what the neurons see of it
(robot/kicks.py). A robot may take the x_i_a of F_i from a moment earlier, see `lagging_angle`.

Equations have their labels in Sandor et al., Front. Neurorobot. 12:40 (2018). This is the only
place where they stand. Every function is pure, takes and returns floats, uses nothing but `math`,
and compiles unchanged under numba.

Units: angles in rad, times in s; membrane potentials, positions, forces and torques are
dimensionless, as in the paper.
"""

from math import cos, exp, sin, tanh


def actual_positions(phi):
    """(x1_a, x2_a) = (cos phi, sin phi). Eq. actual_pos.

    Args:
        phi: The wheel's angle, rad.

    Returns:
        The actual positions of both rods, 1.
    """
    return cos(phi), sin(phi)


def lagging_angle(phi, phi_before, dt_s, lag_s):
    """The wheel's angle some milliseconds before its latest reading. Not in the paper.

    A program that reads the sensor anew in each formula computes F_i from older positions than
    F_tan. With two rods, F_tan then has -k sin(omega lag) in addition, against the motion: a fast
    wheel leaves the saturation of tanh. A line through two readings stands in for a reading of its
    own: the tick need not wait for it, and a log holds all that a replay needs. The two differ by
    at most the angular acceleration times lag (dt - lag) / 2, for an EV3 motor about 1 degree.

    Args:
        phi: The latest reading, rad.
        phi_before: The reading before it, rad.
        dt_s: The time between both, s.
        lag_s: How much earlier, s. More than dt_s counts as dt_s.

    Returns:
        The angle, rad.
    """
    return phi - (phi - phi_before) * min(1.0, lag_s / dt_s)


def target_position(x, a):
    """x_t = 2 y(x) - 1, with the neuron's rate y = 1 / (1 + exp(-a x)). Eq. target_pos.

    Args:
        x: The neuron's membrane potential, 1.
        a: Its gain, 1.

    Returns:
        Where the neuron wants its rod, in (-1, 1).
    """
    return 2.0 / (1.0 + exp(-a * x)) - 1.0


def rod_force(x_target, x_actual, k):
    """F_i = k (x_t - x_a): a spring pulls the rod to its target. Eq. F_i.

    Args:
        x_target: Where the neuron wants the rod, 1.
        x_actual: Where the rod is, 1.
        k: The spring constant, 1.

    Returns:
        The force on the rod, 1.
    """
    return k * (x_target - x_actual)


def membrane_rate(x, x_seen, tau_s):
    """dx/dt = (x_seen - x) / tau: a potential follows the position its neuron sees. Eq. dot_x.

    Args:
        x: The membrane potential, 1.
        x_seen: The position that the neuron sees, 1.
        tau_s: The time constant, s.

    Returns:
        The potential's rate, 1/s.
    """
    return (x_seen - x) / tau_s


def tangential_force(force_1, force_2, actual_1, actual_2):
    """F_tan = F_1 sin phi - F_2 cos phi: what both rods do at the wheel's rim. Eq. F_tan.

    Args:
        force_1: The first rod's force, 1.
        force_2: The second rod's force, 1.
        actual_1: cos phi, the first rod's actual position.
        actual_2: sin phi, the second rod's actual position.

    Returns:
        The force along the rim, 1; positive drives forward.
    """
    return force_1 * actual_2 - force_2 * actual_1


def motor_torque(force):
    """M = tanh(F_tan). Eq. torque.

    Args:
        force: F_tan, 1.

    Returns:
        The torque relative to the motor's maximum, in (-1, 1).
    """
    return tanh(force)


def step_wheel(x1, x2, actual_1, actual_2, rod_1, rod_2, seen_1, seen_2, dt_s, a, tau_s, k, rods):
    """One tick of one wheel, with an Euler step of the neurons.

    The neurons step first, on the positions that they see, and the rods act on the new potentials.
    The forces of the rods are projected at the true angle phi, kicked or not.

    Args:
        x1: First membrane potential, 1.
        x2: Second membrane potential, 1.
        actual_1: The first rod's actual position, 1.
        actual_2: The second rod's actual position, 1.
        rod_1: The first rod's position in its force; the same without a lag of the rods.
        rod_2: The second rod's position in its force.
        seen_1: What the first neuron sees of it; the same without a kick.
        seen_2: What the second neuron sees of it.
        dt_s: The time step, s.
        a: The neurons' gain, 1.
        tau_s: Their time constant, s.
        k: The rods' spring constant, 1.
        rods: 2, or 1 if only the first rod exists.

    Returns:
        (x1, x2, force, torque) after the step: both potentials, F_tan and M.
    """
    x1 += dt_s * membrane_rate(x1, seen_1, tau_s)
    x2 += dt_s * membrane_rate(x2, seen_2, tau_s)
    force_1 = rod_force(target_position(x1, a), rod_1, k)
    force_2 = rod_force(target_position(x2, a), rod_2, k) if rods == 2 else 0.0
    force = tangential_force(force_1, force_2, actual_1, actual_2)
    return x1, x2, force, motor_torque(force)
