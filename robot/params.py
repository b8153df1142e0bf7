"""The table of parameters.

Checks, command line, documentation and dashboards all use this one table.
"""

from collections import OrderedDict
from math import floor, isfinite
from operator import attrgetter
from types import SimpleNamespace

from robot.errors import Refused


# Not a namedtuple, for which Python 3.5 compiles source code: 60 ms of a brick at each start.
def _row(name, unit, minimum, maximum, default, choices, at_rest_only, doc):
    return SimpleNamespace(
        name=name,
        unit=unit,
        minimum=minimum,
        maximum=maximum,
        default=default,
        choices=choices,
        at_rest_only=at_rest_only,
        doc=doc,
    )


def _number(name, unit, minimum, maximum, default, doc):
    return _row(name, unit, minimum, maximum, default, None, False, doc)


def _choice(name, default, choices, doc, at_rest_only=False):
    return _row(name, "", None, None, default, choices, at_rest_only, doc)


# The delta t of a late tick is at most this many control periods. tau must be at least that long,
# or an Euler step could overshoot.
LONGEST_STEP_TICKS = 3
# A number in letters is no longer than this; more are not worth a hint.
LONGEST_NUMBER = 30
# In binary, three times 0.1 is a little more than 0.3.
_ROUNDING_S = 1e-9

_ROWS = (
    _number("a", "1", 0.1, 50.0, 4.0, "gain of the neurons; the slope of their sigmoid is a/4"),
    _number(
        "tau_s",
        "s",
        0.03,
        10.0,
        0.25,
        "time constant of the membrane potentials; at least three tick_s",
    ),
    _number("k", "1", 0.0, 100.0, 8.0, "spring constant of the simulated rods"),
    _number(
        "rod_lag_s",
        "s",
        0.0,
        0.02,
        0.0,
        "how much older the rods' positions in the forces F_i are than the angle in F_tan; at most"
        " one tick_s; 0 in the paper's equations",
    ),
    _number("tick_s", "s", 0.01, 0.1, 0.03, "control period; tau_s must be at least three of them"),
    _number("max_duty_pct", "%", 0.0, 100.0, 85.0, "duty cycle at torque M = 1"),
    _choice(
        "battery_compensation",
        "off",
        ("off", "on"),
        "whether the robot itself sets duty_scale, to nominal / battery voltage",
    ),
    _number(
        "duty_scale",
        "1",
        0.5,
        2.0,
        1.0,
        "factor on every duty cycle; max_duty_pct limits the product",
    ),
    _choice("rods", 2, (1, 2), "transmission rods on each wheel"),
    _choice(
        "polarity_left", 1, (1, -1), "-1 if the left motor is mounted mirrored", at_rest_only=True
    ),
    _choice(
        "polarity_right", 1, (1, -1), "-1 if the right motor is mounted mirrored", at_rest_only=True
    ),
    _choice(
        "link_loss",
        "stop",
        ("stop", "hold", "continue"),
        "what the robot does when it loses the host that drives it",
    ),
    _number(
        "link_loss_s",
        "s",
        0.2,
        10.0,
        0.5,
        "silence after which the host that drives the robot counts as lost",
    ),
)
TABLE = OrderedDict((row.name, row) for row in _ROWS)
# The values that a Params has, as a tuple in the order of the table.
IN_FORCE = attrgetter(*TABLE)


def describe():
    """The table as plain data, as the robot sends it.

    Returns:
        A list of dictionaries with the keys name, unit, minimum, maximum, default, choices and doc.
    """
    keys = ("name", "unit", "minimum", "maximum", "default", "choices", "doc")
    return [OrderedDict((key, getattr(row, key)) for key in keys) for row in _ROWS]


def point_for_comma(value):
    """How to write a number that came with a decimal comma.

    Args:
        value: A value that is not the number that it should be.

    Returns:
        The advice, such as 'write a point: 2.5'; empty if a point does not make it a number.
    """
    if not isinstance(value, str) or len(value) > LONGEST_NUMBER or value.count(",") != 1:
        return ""
    text = value.strip().replace(",", ".")
    try:
        float(text)
    except ValueError:
        return ""
    return "write a point: " + text


def check_value(name, value):
    """Check a value and convert it to the type of its parameter.

    Args:
        name: The parameter's name.
        value: A number or text.

    Returns:
        The value: a float, or one of the parameter's choices.

    Raises:
        Refused: The name is unknown, or the value has a wrong type, is NaN or is out of range.
    """
    row = TABLE.get(name)
    if row is None:
        raise Refused(
            "unknown",
            "there is no parameter '{}'".format(name),
            "parameters are: " + ", ".join(TABLE),
        )
    if row.choices is not None:
        for choice in row.choices:
            if not isinstance(value, bool) and value == choice:
                return choice
        raise Refused(
            "range",
            "{} cannot be {!r}".format(name, value),
            "it is one of " + ", ".join(str(choice) for choice in row.choices),
        )
    if (
        isinstance(value, bool)
        or not isinstance(value, (int, float))
        or not row.minimum <= value <= row.maximum
        or not isfinite(value)
    ):
        raise Refused(
            "range",
            "{} cannot be {!r}".format(name, value),
            point_for_comma(value)
            or "it is a number from {:g} to {:g} {}".format(
                row.minimum, row.maximum, row.unit.replace("1", "")
            ).rstrip(),
        )
    return float(value)


def check_step(tick_s, tau_s):
    """Check that the Euler step after a late tick cannot overshoot.

    Args:
        tick_s: The control period, s.
        tau_s: The time constant of the membrane potentials, s.

    Raises:
        Refused: tau_s is shorter than LONGEST_STEP_TICKS control periods.
    """
    if tau_s < LONGEST_STEP_TICKS * tick_s - _ROUNDING_S:
        raise Refused(
            "range",
            "tau_s {:g} s is shorter than {} ticks of {:g} s".format(
                tau_s, LONGEST_STEP_TICKS, tick_s
            ),
            "the Euler step after a late tick would overshoot: take a longer tau_s or a shorter"
            " tick_s",
        )


def check_lag(rod_lag_s, tick_s):
    """Check that the rods' older angle lies between the latest two readings.

    Args:
        rod_lag_s: How much older it is than the latest, s.
        tick_s: The control period, s.

    Raises:
        Refused: The lag is longer than a control period.
    """
    if rod_lag_s > tick_s:
        raise Refused(
            "range",
            "rod_lag_s {:g} s is longer than a tick of {:g} s".format(rod_lag_s, tick_s),
            "the robot remembers the angle of one tick before: take a shorter rod_lag_s or a longer"
            " tick_s",
        )


def accepted(name, values, at_rest):
    """What a parameter can be set to while the others stay as they are.

    Args:
        name: The parameter's name.
        values: The parameters in force, by name.
        at_rest: Whether the robot stands still.

    Returns:
        Of a number (least, greatest), to 0.1 ms: `Params.check` takes both. Else the choices that
        it takes.
    """
    row = TABLE[name]
    if row.choices is not None:
        return row.choices if at_rest or not row.at_rest_only else (values[name],)
    least, greatest = row.minimum, row.maximum
    if name == "tau_s":
        least = max(least, round(LONGEST_STEP_TICKS * values["tick_s"], 9))
    elif name == "tick_s":
        least = max(least, values.get("rod_lag_s", 0.0))  # an older robot has none
        longest_s = (values["tau_s"] + _ROUNDING_S) / LONGEST_STEP_TICKS
        greatest = max(least, min(greatest, floor(1e4 * longest_s) / 1e4))
    elif name == "rod_lag_s":
        greatest = min(greatest, values["tick_s"])
    return least, greatest


class Params(object):
    """The values in force. Each parameter is an attribute."""

    def __init__(self):
        for row in _ROWS:
            setattr(self, row.name, row.default)

    def values(self):
        """The values in force.

        Returns:
            An OrderedDict from name to value, in the order of the table.
        """
        return OrderedDict(zip(TABLE, IN_FORCE(self)))

    def check(self, changes, at_rest=True):
        """Check changes without making them.

        Args:
            changes: New values by name.
            at_rest: Whether the robot stands still; some parameters change only then.

        Returns:
            An OrderedDict with the changes, each in its parameter's own type.

        Raises:
            Refused: One of the changes is wrong; none may be made.
        """
        if not isinstance(changes, dict) or not changes:
            raise Refused("usage", "no parameter is named", "name at least one, as in k=8")
        checked = OrderedDict((name, check_value(name, changes[name])) for name in sorted(changes))
        for name in checked:
            if TABLE[name].at_rest_only and not at_rest and checked[name] != getattr(self, name):
                raise Refused(
                    "state",
                    "{} cannot change while the robot runs".format(name),
                    "stop the robot first: kickctl stop",
                )
        tick_s = checked.get("tick_s", self.tick_s)
        check_step(tick_s, checked.get("tau_s", self.tau_s))
        check_lag(checked.get("rod_lag_s", self.rod_lag_s), tick_s)
        return checked

    def apply(self, checked):
        """Make changes.

        Args:
            checked: What `check` returned.
        """
        for name in checked:
            setattr(self, name, checked[name])
