"""What the tests of experiments on bodies share: short settings, and runs that are made up."""

import importlib
import json
from typing import NotRequired, get_origin, get_type_hints

import numpy as np

from host.experiments.bodies.simulation import BodyRun
from host.experiments.registry import TABLE
from host.runs.contract import Setting
from sim_motor.bodies.measures import Course

SHORT = {"seconds": 3.0, "seeds": 2, "trials": 1, "goals": 1, "preset": "paper"}


def setting(name, seed=1, **options):
    return Setting(
        seed,
        {
            option.name: options.get(option.name, SHORT[option.name])
            for option in TABLE[name].options
        },
    )


def module(name):
    return importlib.import_module("host.experiments.bodies." + name.replace("-", "_"))


def plain(data):
    return json.loads(json.dumps(data, allow_nan=False))


def build_run(omega, x=0.0, y=0.0, dt_s=0.005):
    """A run whose wheels turned at omega (times, wheels), and whose middle was at x, y."""
    omega = np.asarray(omega, dtype=float)
    t = np.arange(len(omega)) * dt_s
    centre = np.stack(
        [np.broadcast_to(x, t.shape), np.broadcast_to(y, t.shape), np.zeros_like(t)], axis=1
    )
    return BodyRun(Course(t, omega, centre, np.zeros_like(t)), np.zeros((len(t), 8)), centre, None)


def has_columns_of(row, kind):
    """Whether a row has all columns of a TypedDict, and no others."""
    columns = get_type_hints(kind, include_extras=True)
    needed = {name for name, hint in columns.items() if get_origin(hint) is not NotRequired}
    return needed <= set(row) <= set(columns)
