"""Small functions to compile, for this process and for others."""

import hashlib

import numpy as np
from numba.core import event

from sim_motor.compiled import jit
from sim_motor.constants import load
from sim_motor.replay import replay


def build(source, finish=jit, **names):
    """The function `f` of a source text, compiled, as a new process would have it.

    Also its globals, to be changed behind its back.
    """
    names |= {"__name__": __name__, "finish": finish}
    exec(source, names)  # noqa: S102
    return finish(names["f"]), names


def line(factor, finish=jit):
    """A compiled function x -> factor * x, that calls a compiled one."""
    inner = f"@finish\ndef inner(x):\n    return {factor} * x\n"
    return build(inner + "def f(x):\n    return inner(x)", finish)[0]


def counts(function):
    """How often numba compiled a function, and how often it was loaded."""
    return sum(function.stats.cache_misses.values()), sum(function.stats.cache_hits.values())


def call(function, *arguments):
    """What a function returns, and its counts."""
    return function(*arguments), counts(function)


def motors_run():
    """What two motors do in a second: a digest of all bits, and whether numba compiled."""
    with event.install_recorder("numba:compile") as recorder:
        times = np.arange(0.0, 1.0, 0.03)
        duties = np.full((2, len(times)), 50)
        motors, volts = (load(),), np.array([8.0, 7.0])
        found = replay(np.zeros((2, 6)), times, duties, 1.0, motors, volts)
    bits = b"".join(one.tobytes() for one in found)
    return f"{hashlib.sha256(bits).hexdigest()} {bool(recorder.buffer)}"
