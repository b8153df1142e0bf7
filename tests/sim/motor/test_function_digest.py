"""The digest of a function: all that changes what it computes changes it, and nothing else does."""

import cmath
import math
import types

import numba
import numba.extending
import numpy as np
import pytest

from sim_motor.compiled import inner_jit, jit, njit
from sim_motor.function_digest import function_digest
from sim_motor.mathematics import with_mathematics


def digest(source, name="f", options=None, **names):
    """The digest of the function `name` of a source text."""
    exec(source, names)  # noqa: S102
    return function_digest(names[name], options or {})


BASE = "def f(x, y=1.0):\n    return a * x + y"


@pytest.mark.parametrize(
    ("source", "names", "options"),
    [
        ("def f(x, y=1.0):\n    return a * x - y", {"a": 2.0}, {}),
        ("def f(x, y=1.5):\n    return a * x + y", {"a": 2.0}, {}),
        ("def f(x, y=1.0):\n    return b * x + y", {"b": 2.0}, {}),
        (BASE, {"a": 3.0}, {}),
        (BASE, {"a": 2}, {}),
        (BASE, {"a": np.array([2.0])}, {}),
        (BASE, {"a": 2.0}, {"fastmath": {"nsz", "arcp"}}),
        (BASE, {"a": 2.0, "__name__": "elsewhere"}, {}),
    ],
)
def test_what_changes_the_result_changes_it(source, names, options):
    assert digest(source, options=options, **names) != digest(BASE, a=2.0)


@pytest.mark.parametrize("before", ["", "\n\n", "# a comment\n", "unused = 3\n"])
def test_where_a_function_stands_does_not_change_it(before):
    assert digest(before + BASE, a=2.0) == digest(BASE, a=2.0)


def test_numbers_within_the_code_count_though_its_bytes_are_the_same():
    codes = [(lambda x: 2.0 * x), (lambda x: 3.0 * x)]
    assert codes[0].__code__.co_code == codes[1].__code__.co_code
    assert len({function_digest(code, {}) for code in codes}) == 2


def test_what_a_function_calls_counts_at_any_depth():
    def chain(factor, finish):
        names = {"factor": factor, "finish": finish}
        exec("inner = finish(lambda x: factor * x)", names)  # noqa: S102
        exec("outer = finish(lambda x: inner(x))", names)  # noqa: S102
        return function_digest(eval("lambda x: outer(x)", names), {})  # noqa: S307

    assert chain(2.0, jit) == chain(2.0, jit)
    assert len({chain(2.0, jit), chain(3.0, jit), chain(2.0, njit), chain(2.0, inner_jit)}) == 4


def test_what_a_closure_holds_counts():
    def scaled(factor):
        return lambda x: factor * x

    assert function_digest(scaled(2.0), {}) == function_digest(scaled(2.0), {})
    assert function_digest(scaled(2.0), {}) != function_digest(scaled(3.0), {})


def test_what_is_taken_from_a_module_counts():
    def of(value):
        return digest("def f(x):\n    return m.a * x", m=module(a=value))

    def module(**names):
        m = types.ModuleType("m")
        vars(m).update(names)
        return m

    assert of(2.0) == of(2.0)
    assert of(2.0) != of(3.0)
    assert of(jit(lambda x: x)) != of(jit(lambda x: 2 * x))


def test_another_mathematics_is_another_function():
    def wave(x):
        return math.sin(x)

    assert function_digest(wave, {}) == function_digest(with_mathematics(wave, {"math": math}), {})
    assert function_digest(wave, {}) != function_digest(with_mathematics(wave, {"math": cmath}), {})


def test_an_intrinsic_counts_by_its_definition():
    def intrinsic(sign):
        def negated(context, value):
            return numba.types.int64(numba.types.int64), lambda *_: sign

        return digest("def f(x):\n    return i(x)", i=numba.extending.intrinsic(negated))

    assert intrinsic(1) == intrinsic(1)
    assert intrinsic(1) != intrinsic(-1)


def test_a_function_may_call_itself():
    source = "def f(x):\n    return f(x - 1) if x else {}"
    assert digest(source.format(1)) == digest(source.format(1))
    assert digest(source.format(1)) != digest(source.format(2))


def test_it_is_the_same_once_the_function_is_compiled():
    names = {"jit": jit}
    exec("def f(x):\n    return f(x - 1) if x else 1", names)  # noqa: S102
    plain = names["f"]
    before = function_digest(plain, {})
    names["f"] = jit(plain)
    assert function_digest(plain, {}) == before


def test_what_does_not_exist_yet_is_named():
    with pytest.raises(NameError, match="f needs a, which does not exist yet: define it above"):
        digest(BASE)


def test_what_has_no_known_content_is_refused():
    with pytest.raises(TypeError, match="is not known"):
        digest(BASE, a=object())
