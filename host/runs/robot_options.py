"""The robot's parameters as options of an experiment: --k, --tau, --a and --tick."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from host.errors import WrongUse
from host.runs.registry import Option
from robot.errors import Refused
from robot.params import TABLE, Params

# The parameter of the robot that an option sets, and what its help says.
_PARAMETERS = {
    "k": ("k", "spring constant of the rods, without unit"),
    "tau": ("tau_s", "time constant of the membrane potentials, s; at least three ticks"),
    "a": ("a", "gain of the neurons, without unit"),
    "tick": ("tick_s", "control period, s"),
}
NAMES = tuple(_PARAMETERS)


def robot_options(**own: float) -> tuple[Option, ...]:
    """The options, with the robot's defaults but for those of the experiment's own."""
    rows = [(name, TABLE[parameter], doc) for name, (parameter, doc) in _PARAMETERS.items()]
    return tuple(
        Option(name, own.get(name, row.default), row.minimum, row.maximum, doc)
        for name, row, doc in rows
    )


def params_of(options: Mapping[str, Any]) -> dict[str, float]:
    """The robot's parameters that options set, by the robot's names."""
    return {
        parameter: options[name] for name, (parameter, _) in _PARAMETERS.items() if name in options
    }


def defaults_besides(options: Mapping[str, Any]) -> dict[str, float]:
    """The defaults of the robot's parameters that a run has no option for, as options name them."""
    return {
        name: TABLE[parameter].default
        for name, (parameter, _) in _PARAMETERS.items()
        if name not in options
    }


def options_of(params: Mapping[str, Any]) -> dict[str, Any]:
    """The options that would set these parameters of the robot, as far as there are any."""
    return {
        name: params[parameter]
        for name, (parameter, _) in _PARAMETERS.items()
        if parameter in params
    }


def params_with(**changes: float) -> Params:
    """The default parameters with these changes. Raises WrongUse if the robot would refuse them."""
    params = Params()
    try:
        if changes:
            params.apply(params.check(changes))
    except Refused as refusal:
        raise WrongUse(refusal.message, refusal.hint) from refusal
    return params
