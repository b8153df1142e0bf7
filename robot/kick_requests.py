"""Requests for kicks, checked: from what came over the wire to a robot.kicks.Kick."""

from math import isfinite, pi

from robot.errors import Refused
from robot.kicks import (
    DEFAULT_TICKS,
    FROZEN_MODES,
    JUMP,
    MAX_JUMP,
    MAX_TICKS,
    MODES,
    PHASE,
    POSITION,
    PULSE,
    PULSE_BETA,
    PULSE_SHIFT,
    PULSED,
    RECTANGULAR,
    SMOOTH,
    WHEELS,
    Kick,
    reversing_shift,
)
from robot.params import TABLE, check_step, check_value

FIELDS = (
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
_OWN_FIELDS = {PHASE: ("shift",), PULSE: ("param", "value"), JUMP: ("variable", "delta")}


def parse(request, directions, params, begin):
    """The kick that a request asks for.

    Args:
        request: A dict with id, mode and, as the mode needs them, wheel, ticks, shape, shift (rad),
            param and value, variable and delta.
        directions: The present direction of the left and the right wheel, from which a phase kick
            takes its sign if the request gives no shift.
        params: The robot's Params.
        begin: The number of the kick's first tick.

    Returns:
        A Kick.

    Raises:
        Refused: Something in the request is unknown, missing or out of range.
    """
    for name in request:
        if name not in FIELDS:
            raise Refused("usage", "a kick has no '{}'".format(name), "it has " + ", ".join(FIELDS))
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
