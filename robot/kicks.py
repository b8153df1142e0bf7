"""Kick control: the kick as data, and what it does to a wheel as pure functions.

A frozen kick jumps the neurons' variables once; a quenched kick changes one parameter for some
ticks (section 'Kick control' of the paper). Position inversion is a pulse of beta, the phase shift
a pulse of the shift that multiplies gamma; both change only what the neurons see. The numeric
functions use nothing but `math` and scalars, so that numba compiles them unchanged.
"""

from math import cos, pi, sin

MEMBRANE, POSITION, PHASE, PULSE, JUMP = "membrane", "position", "phase", "pulse", "jump"
WAVEFORM = "waveform"
MODES = (MEMBRANE, POSITION, PHASE, PULSE, JUMP, WAVEFORM)
FROZEN_MODES = (MEMBRANE, JUMP)
WHEELS = ("left", "right")
RECTANGULAR, SMOOTH = "rectangular", "smooth"

# What a kick does. The numbers are what compiled code carries in place of the names.
NO_ACTION, INVERT, JUMP_X1, JUMP_X2, QUENCH = range(5)
# What a quenched kick may pulse.
NO_PULSE, PULSE_A, PULSE_TAU, PULSE_K, PULSE_BETA, PULSE_SHIFT = range(6)
PULSED = {
    "a": PULSE_A,
    "tau_s": PULSE_TAU,
    "k": PULSE_K,
    "beta": PULSE_BETA,
    "shift_rad": PULSE_SHIFT,
}
# No kick, in the numbers of Kick.numbers.
NO_KICK = (NO_ACTION, 0, 0, NO_PULSE, False, 0.0, ())

DEFAULT_SHIFT_RAD = 3 * pi / 4
DEFAULT_TICKS = {MEMBRANE: 1, POSITION: 3, PHASE: 4, PULSE: 4, JUMP: 1}
MAX_TICKS = 10000
# With this many values a request and an event fit into a frame.
MAX_WAVEFORM = 100
MAX_JUMP = 2.0
X_LIMIT = 10.0

# A wheel's direction is the sign of its travel over this many ticks; up to two counts of the 1
# degree encoder are rest.
DIRECTION_TICKS = 8
REST_TRAVEL_RAD = 2.5 * pi / 180


def direction(travel_rad):
    """Which way a wheel turns.

    Args:
        travel_rad: Its travel over the last DIRECTION_TICKS ticks, rad.

    Returns:
        1 forward, -1 backward, 0 at rest.
    """
    if travel_rad > REST_TRAVEL_RAD:
        return 1
    if travel_rad < -REST_TRAVEL_RAD:
        return -1
    return 0


def reversing_shift(wheel_direction):
    """The phase shift that turns a wheel around. Caption of fig. resultsKickControl.

    Args:
        wheel_direction: 1, -1 or 0, see `direction`.

    Returns:
        The shift, rad. A positive one takes forward to backward.
    """
    return -DEFAULT_SHIFT_RAD if wheel_direction < 0 else DEFAULT_SHIFT_RAD


def invert_membrane(x1, x2):
    """x_i -> -x_i. Eq. kickControl_membrane_inversion.

    Args:
        x1: First membrane potential, 1.
        x2: Second membrane potential, 1.

    Returns:
        Both potentials after the kick.
    """
    return -x1, -x2


def jump(x, delta):
    """x -> x + delta, within the range where the neurons' exponential is finite.

    Eq. frozen_kick_kontrol.

    Args:
        x: A membrane potential, 1.
        delta: How far it jumps, 1.

    Returns:
        The potential after the kick.
    """
    return max(-X_LIMIT, min(X_LIMIT, x + delta))


def seen_positions(phi, beta, shift_rad):
    """What the neurons see of a wheel: (1 - 2 beta) (cos, sin)(phi + shift).

    Eqs. kickControl_xa_inversion and kickControl_delta_phi in one.

    Args:
        phi: The wheel's angle, rad.
        beta: 0 to 1; at 1 the positions are inverted.
        shift_rad: The phase shift, rad.

    Returns:
        The two positions, 1. With beta = shift = 0 they are the actual ones.
    """
    sign = 1.0 - 2.0 * beta
    return sign * cos(phi + shift_rad), sign * sin(phi + shift_rad)


def pulse_weight(age, ticks, smooth):
    """How much of a pulse acts in one of its ticks.

    Args:
        age: The number of the tick, 0 to ticks - 1.
        ticks: How many ticks the pulse lasts.
        smooth: Whether it is sin^2 shaped, else it is rectangular.

    Returns:
        0 to 1; always 1 if rectangular.
    """
    return sin(pi * (age + 0.5) / ticks) ** 2 if smooth else 1.0


def apply_pulse(pulse, value, weight, a, tau_s, k):
    """The parameters of a wheel during a quenched kick. Eq. quenched_kick_kontrol.

    Args:
        pulse: The number of the parameter that is pulsed, NO_PULSE to PULSE_SHIFT.
        value: That parameter at the pulse's height.
        weight: How much of the pulse acts, see `pulse_weight`.
        a: Gain without the kick, 1.
        tau_s: Time constant without the kick, s.
        k: Spring constant without the kick, 1.

    Returns:
        (a, tau_s, k, beta, shift_rad); beta and the shift are 0 without the kick.
    """
    beta = 0.0
    shift_rad = 0.0
    if pulse == PULSE_A:
        a += weight * (value - a)
    elif pulse == PULSE_TAU:
        tau_s += weight * (value - tau_s)
    elif pulse == PULSE_K:
        k += weight * (value - k)
    elif pulse == PULSE_BETA:
        beta = weight * value
    elif pulse == PULSE_SHIFT:
        shift_rad = weight * value
    return a, tau_s, k, beta, shift_rad


def apply_kick(kick, tick, x1, x2, a, tau_s, k):
    """What a kick does to a wheel in a tick, before the neurons step.

    Args:
        kick: The numbers of a kick on this wheel, see Kick.numbers.
        tick: The number of the tick.
        x1: First membrane potential, 1.
        x2: Second membrane potential, 1.
        a: Gain, 1.
        tau_s: Time constant, s.
        k: Spring constant, 1.

    Returns:
        (x1, x2, a, tau_s, k, beta, shift_rad) in this tick; beta and the shift, rad, are for
        `seen_positions`. In a tick in which the kick does not act, all is as before and these are
        0.
    """
    action, begin, ticks, pulse, smooth, value, waveform = kick
    beta = 0.0
    shift_rad = 0.0
    age = tick - begin
    if 0 <= age < ticks:
        if len(waveform):
            value = waveform[age]
        if action == QUENCH:
            weight = pulse_weight(age, ticks, smooth)
            a, tau_s, k, beta, shift_rad = apply_pulse(pulse, value, weight, a, tau_s, k)
        elif action == INVERT:
            x1, x2 = invert_membrane(x1, x2)
        elif action == JUMP_X1:
            x1 = jump(x1, value)
        elif action == JUMP_X2:
            x2 = jump(x2, value)
    return x1, x2, a, tau_s, k, beta, shift_rad


class Kick(object):
    """One kick, checked and complete: nothing about it is left to decide when it acts.

    Attributes:
        id: The name that the request gave it.
        mode: One of MODES.
        wheels: The names of the wheels that it acts on.
        ticks: How many ticks it lasts.
        smooth: Whether a pulse is sin^2 shaped, else it is rectangular.
        pulse: The number of the parameter that is pulsed, or NO_PULSE.
        values: That parameter at the pulse's height, on the left and the right wheel.
        variable: "x1" or "x2" if the kick moves a membrane potential, else None.
        delta: How far that jumps, 1.
        begin: The number of its first tick.
        waveform: One value for each tick: of the pulsed parameter, or how far the potential jumps
            then. Empty for other modes.
    """

    __slots__ = (
        "id",
        "mode",
        "wheels",
        "ticks",
        "smooth",
        "pulse",
        "values",
        "variable",
        "delta",
        "begin",
        "waveform",
    )

    def __init__(
        self,
        id,
        mode,
        wheels,
        ticks,
        smooth=False,
        pulse=NO_PULSE,
        values=(0.0, 0.0),
        variable=None,
        delta=0.0,
        begin=0,
        waveform=(),
    ):
        self.id = id
        self.mode = mode
        self.wheels = tuple(wheels)
        self.ticks = ticks
        self.smooth = smooth
        self.pulse = pulse
        self.values = tuple(values)
        self.variable = variable
        self.delta = delta
        self.begin = begin
        self.waveform = tuple(waveform)

    def acts_at(self, tick):
        """Whether the kick acts in this tick."""
        return self.begin <= tick < self.begin + self.ticks

    def numbers(self, index):
        """The kick on one of its wheels, as `apply_kick` takes it.

        Args:
            index: 0 for a left wheel, 1 for a right one.

        Returns:
            (action, begin, ticks, pulse, smooth, value, waveform). The value is a pulse's height or
            how far a potential jumps. Values of a waveform stand in its place, one a tick.
        """
        if self.pulse:
            action, value = QUENCH, self.values[index]
        elif self.mode == MEMBRANE:
            action, value = INVERT, 0.0
        else:
            action, value = (JUMP_X1 if self.variable == "x1" else JUMP_X2), self.delta
        return action, self.begin, self.ticks, self.pulse, self.smooth, value, self.waveform

    def as_dict(self):
        """The kick as plain data, from which `Kick(**data)` is the same kick.

        Hosts of older releases know no waveform, so a kick without one does not name it.
        """
        names = self.__slots__ if self.waveform else self.__slots__[:-1]
        return {name: getattr(self, name) for name in names}
