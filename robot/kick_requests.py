"""Requests for kicks, checked: from what came over the wire to a robot.kicks.Kick."""

from math import isfinite, pi

from robot.errors import Refused
from robot.kicks import (
    DEFAULT_TICKS,
    FROZEN_MODES,
    JUMP,
    MAX_JUMP,
    MAX_TICKS,
    MAX_WAVEFORM,
    MODES,
    PHASE,
    POSITION,
    PULSE,
    PULSE_BETA,
    PULSE_SHIFT,
    PULSED,
    RECTANGULAR,
    SMOOTH,
    WAVEFORM,
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
    "waveform",
)
# The fields that only some modes have.
_OWNERS = {
    "shift": (PHASE,),
    "param": (PULSE, WAVEFORM),
    "value": (PULSE,),
    "variable": (JUMP,),
    "delta": (JUMP,),
    "waveform": (WAVEFORM,),
}
_POTENTIALS = ("x1", "x2")
# What a waveform may change.
CHANGED = tuple(sorted(PULSED)) + _POTENTIALS


def parse(request, directions, params, begin):
    """The kick that a request asks for.

    Args:
        request: A dict with id, mode and, as the mode needs them, wheel, ticks, shape, shift (rad),
            param and value, variable and delta, waveform.
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
    ticks, smooth = _parse_length(request, mode)
    kick = Kick(identity, mode, WHEELS if wheel == "both" else (wheel,), ticks, smooth, begin=begin)
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
        kick.variable = _choice(request, "variable", _POTENTIALS, None)
        kick.delta = _number(request, "delta", MAX_JUMP)
    elif mode == WAVEFORM:
        name = _choice(request, "param", CHANGED, None)
        kick.waveform = _parse_waveform(request, name, params)
        kick.ticks = len(kick.waveform)
        kick.pulse = PULSED.get(name, kick.pulse)
        kick.variable = name if name in _POTENTIALS else None
    return kick


def _parse_length(request, mode):
    """How many ticks a kick lasts, and whether its shape is smooth."""
    smooth = _choice(request, "shape", (RECTANGULAR, SMOOTH), RECTANGULAR) == SMOOTH
    ticks = request.get("ticks", DEFAULT_TICKS.get(mode, 1))
    if isinstance(ticks, bool) or not isinstance(ticks, int) or not 1 <= ticks <= MAX_TICKS:
        raise Refused(
            "range",
            "ticks cannot be {!r}".format(ticks),
            "give a whole number from 1 to {}".format(MAX_TICKS),
        )
    if mode in FROZEN_MODES and (ticks != 1 or smooth):
        raise Refused(
            "usage", "a {} kick is one jump in one tick".format(mode), "leave out ticks and shape"
        )
    if mode == WAVEFORM and ("ticks" in request or smooth):
        raise Refused(
            "usage", "a waveform says its own length and shape", "leave out ticks and shape"
        )
    return ticks, smooth


def _reject_foreign(request, mode):
    for name in sorted(_OWNERS):
        if mode not in _OWNERS[name] and request.get(name) is not None:
            raise Refused(
                "usage",
                "{} does not belong to a {} kick".format(name, mode),
                "it belongs to mode " + " or ".join(_OWNERS[name]),
            )


def _parse_pulse(request, params):
    name = _choice(request, "param", tuple(sorted(PULSED)), None)
    if request.get("value") is None:
        raise Refused(
            "usage",
            "value is missing",
            "give the value that {} takes at the pulse's height".format(name),
        )
    value = _check_changed(request, name, params)
    return PULSED[name], (value, value)


def _check_changed(request, name, params):
    """The value in a request of what a kick changes; x1 and x2 change by it."""
    if name not in TABLE:
        limits = {"shift_rad": 2 * pi, "beta": 1.0}
        return _number(request, "value", limits.get(name, MAX_JUMP))
    value = check_value(name, request["value"])
    if name == "tau_s":
        check_step(params.tick_s, value)
    return value


def _parse_waveform(request, name, params):
    values = request.get("waveform")
    if not isinstance(values, (list, tuple)) or not 0 < len(values) <= MAX_WAVEFORM:
        raise Refused(
            "range" if isinstance(values, (list, tuple)) else "usage",
            "a waveform has one value for each tick, 1 to {} of them".format(MAX_WAVEFORM),
            "give a list of numbers",
        )
    checked = []
    for value in values:
        try:
            checked.append(_check_changed({"value": value}, name, params))
        except Refused as refusal:
            raise Refused(
                refusal.code,
                "value {} of the waveform of {}: {}".format(
                    len(checked) + 1, name, refusal.message
                ),
                refusal.hint,
            ) from refusal
    return tuple(checked)


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
