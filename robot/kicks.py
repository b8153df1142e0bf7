"""Kick control: the kick as data, and its effect on a wheel as pure functions.

A frozen kick jumps the neurons' variables once; a quenched kick changes one parameter for some
ticks (section 'Kick control' of the paper). Position inversion is a pulse of beta, the phase shift
a pulse of the shift that multiplies gamma; both alter only what the neurons see. The numeric
functions use nothing but `math` and scalars, so that numba compiles them unchanged.
"""

from math import cos, isfinite, pi, sin

from robot.errors import Refused
from robot.params import TABLE, check_step, check_value

MEMBRANE, POSITION, PHASE, PULSE, JUMP = "membrane", "position", "phase", "pulse", "jump"
MODES = (MEMBRANE, POSITION, PHASE, PULSE, JUMP)
FROZEN_MODES = (MEMBRANE, JUMP)
WHEELS = ("left", "right")
RECTANGULAR, SMOOTH = "rectangular", "smooth"

# What a quenched kick may pulse. The numbers are what compiled code carries in place of the names.
NO_PULSE, PULSE_A, PULSE_TAU, PULSE_K, PULSE_BETA, PULSE_SHIFT = range(6)
PULSED = {
    "a": PULSE_A,
    "tau_s": PULSE_TAU,
    "k": PULSE_K,
    "beta": PULSE_BETA,
    "shift_rad": PULSE_SHIFT,
}

DEFAULT_SHIFT_RAD = 3 * pi / 4
DEFAULT_TICKS = {MEMBRANE: 1, POSITION: 3, PHASE: 4, PULSE: 4, JUMP: 1}
MAX_TICKS = 10000
MAX_JUMP = 2.0
X_LIMIT = 10.0

# A wheel's direction is the sign of its travel over this many ticks; up to two counts of the 1
# degree encoder are rest.
DIRECTION_TICKS = 8
REST_TRAVEL_RAD = 2.5 * pi / 180


def direction(travel_rad):
    """1 forward, -1 backward, 0 at rest, from a wheel's travel over the last DIRECTION_TICKS ticks."""
    if travel_rad > REST_TRAVEL_RAD:
        return 1
    if travel_rad < -REST_TRAVEL_RAD:
        return -1
    return 0


def reversing_shift(wheel_direction):
    """The phase shift (rad) that turns a wheel around: positive takes forward to backward.

    Caption of fig. resultsKickControl.
    """
    return -DEFAULT_SHIFT_RAD if wheel_direction < 0 else DEFAULT_SHIFT_RAD


def invert_membrane(x1, x2):
    """x_i -> -x_i. Eq. kickControl_membrane_inversion."""
    return -x1, -x2


def seen_positions(phi, beta, shift_rad):
    """What the neurons see of a wheel at angle phi: (1 - 2 beta) (cos, sin)(phi + shift).

    Eqs. kickControl_xa_inversion and kickControl_delta_phi in one; with beta = shift = 0 these are
    the actual positions.
    """
    sign = 1.0 - 2.0 * beta
    return sign * cos(phi + shift_rad), sign * sin(phi + shift_rad)


def pulse_weight(age, ticks, smooth):
    """How much of a pulse acts in its tick number age = 0 .. ticks - 1.

    1 if rectangular, sin^2 shaped (up to 1) if smooth.
    """
    return sin(pi * (age + 0.5) / ticks) ** 2 if smooth else 1.0


def pulsed(pulse, value, weight, a, tau_s, k):
    """(a, tau_s, k, beta, shift_rad) while the parameter numbered `pulse` is on its way to value.

    Eq. quenched_kick_kontrol.
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


def jump(x, delta):
    """x -> x + delta, kept within the range in which the neurons' exponential is finite. Eq.

    frozen_kick_kontrol.
    """
    return max(-X_LIMIT, min(X_LIMIT, x + delta))


class Kick(object):
    """One kick, checked and complete: nothing about it is left to be decided when it acts.

    `values` are the pulse's target on the left and the right wheel; `variable` and `delta` belong
    to a jump.
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

    def acts_at(self, tick):
        """Whether the kick acts in this tick."""
        return self.begin <= tick < self.begin + self.ticks

    def as_dict(self):
        """The kick as plain data, from which `Kick(**data)` is the same kick."""
        return {name: getattr(self, name) for name in self.__slots__}


def _number(request, name, limit):
    value = request.get(name)
    if value is None:
        raise Refused(
            "usage",
            "{} is missing".format(name),
            "give a number from {:g} to {:g}".format(-limit, limit),
        )
    if (
        isinstance(value, bool)
        or not isinstance(value, (int, float))
        or not abs(value) <= limit
        or not isfinite(value)
    ):
        raise Refused(
            "range",
            "{} cannot be {!r}".format(name, value),
            "give a number from {:g} to {:g}".format(-limit, limit),
        )
    return float(value)


def _choice(request, name, choices, default):
    value = request.get(name, default)
    if value is None:
        raise Refused("usage", "{} is missing".format(name), "it is one of " + ", ".join(choices))
    if value not in choices:
        raise Refused(
            "usage", "{} cannot be {!r}".format(name, value), "it is one of " + ", ".join(choices)
        )
    return value


def parse(request, directions, params, begin):
    """The Kick that a request asks for, to begin in tick `begin`.

    request: id, mode and, as the mode needs them, wheel, ticks, shape, shift (rad), param and
    value, variable and delta. directions: the present direction of the left and the right wheel,
    from which a phase kick takes its sign if none is given. Raises Refused if anything in the
    request is unknown, missing or out of range.
    """
    known = (
        "id",
        "mode",
        "wheel",
        "ticks",
        "shape",
        "shift",
        "param",
        "value",
        "variable",
        "delta",
    )
    for name in request:
        if name not in known:
            raise Refused("usage", "a kick has no '{}'".format(name), "it has " + ", ".join(known))
    identity = request.get("id")
    if not isinstance(identity, str) or not 0 < len(identity) <= 64:
        raise Refused(
            "usage", "a kick needs an id of 1 to 64 characters", "any text that was not used before"
        )
    mode = _choice(request, "mode", MODES, None)
    wheel = _choice(request, "wheel", WHEELS + ("both",), "both")
    smooth = _choice(request, "shape", (RECTANGULAR, SMOOTH), RECTANGULAR) == SMOOTH
    ticks = request.get("ticks", DEFAULT_TICKS[mode])
    if isinstance(ticks, bool) or not isinstance(ticks, int) or not 1 <= ticks <= MAX_TICKS:
        raise Refused(
            "range",
            "ticks cannot be {!r}".format(ticks),
            "give a whole number from 1 to {}".format(MAX_TICKS),
        )
    kick = Kick(identity, mode, WHEELS if wheel == "both" else (wheel,), ticks, smooth, begin=begin)
    if mode in FROZEN_MODES and (ticks != 1 or smooth):
        raise Refused(
            "usage", "a {} kick is one jump in one tick".format(mode), "leave out ticks and shape"
        )
    _reject_foreign(request, mode)
    if mode == POSITION:
        kick.pulse, kick.values = PULSE_BETA, (1.0, 1.0)
    elif mode == PHASE:
        kick.pulse = PULSE_SHIFT
        if request.get("shift") is None:
            kick.values = tuple(reversing_shift(sign) for sign in directions)
        else:
            kick.values = (_number(request, "shift", 2 * pi),) * 2
    elif mode == PULSE:
        kick.pulse, kick.values = _parse_pulse(request, params)
    elif mode == JUMP:
        kick.variable = _choice(request, "variable", ("x1", "x2"), None)
        kick.delta = _number(request, "delta", MAX_JUMP)
    return kick


_OWN_FIELDS = {PHASE: ("shift",), PULSE: ("param", "value"), JUMP: ("variable", "delta")}


def _reject_foreign(request, mode):
    for owner in sorted(_OWN_FIELDS):
        for name in _OWN_FIELDS[owner]:
            if owner != mode and request.get(name) is not None:
                raise Refused(
                    "usage",
                    "{} does not belong to a {} kick".format(name, mode),
                    "it belongs to mode " + owner,
                )


def _parse_pulse(request, params):
    name = _choice(request, "param", tuple(sorted(PULSED)), None)
    if request.get("value") is None:
        raise Refused(
            "usage",
            "value is missing",
            "give the value that {} takes at the pulse's height".format(name),
        )
    if name in TABLE:
        value = check_value(name, request.get("value"))
        if name == "tau_s":
            check_step(params.tick_s, value)
    else:
        value = _number(request, "value", 2 * pi if name == "shift_rad" else 1.0)
    return PULSED[name], (value, value)
