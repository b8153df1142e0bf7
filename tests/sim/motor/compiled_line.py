"""Small functions to compile, for this process and for others."""

from sim_motor.compiled import jit


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
