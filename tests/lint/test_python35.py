"""robot/ passes the Python 3.5 gate, and the gate catches what it is there for."""

import pytest

from tests.lint.python35 import violations
from tests.lint.sources import ROOT, modules, robot_tests

LATER = {
    "f-string": "print(f'{1}')",
    "annotated variable": "x: int = 1",
    "underscored number": "x = 1_000",
    "walrus": "if (x := 1): pass",
    "positional-only": "def f(a, /): pass",
    "match": "match 1:\n    case 1: pass",
    "parenthesised with": "with (open('a') as f, open('b') as g): pass",
    "asynchronous generator": "async def f():\n    yield 1",
    "asynchronous comprehension": "async def f(a):\n    return [x async for x in a]",
    "comma after *args": "def f(\n    a,\n    *args,  # why\n): pass",
    "comma after **kwargs": "def f(**kwargs,): pass",
    "comma after keyword-only": "def f(a, *, b=(1, 2),): pass",
    "comma in a decorated method": (
        "class A:\n    @property\n    def f(self, *, b={1: (2,)},): pass"
    ),
    "return star": "def f(a):\n    return 1, *a",
    "yield star": "def f(a):\n    yield 1, *a",
    "for star": "for x in 1, *[2]: pass",
    "continue in finally": "while True:\n    try: pass\n    finally: continue",
    "later module": "import secrets",
    "later function": "import time\ntime.monotonic_ns()",
    "later name": "from math import tau",
    "later class": "import enum\nenum.IntFlag",
    "later argument": "import subprocess\nsubprocess.run(['a'], capture_output=True)",
    "union in isinstance": "isinstance(1, int | str)",
    "annotated argument": "def f(a: 'int', *b): pass",
    "annotated result": "def f(a) -> 'int': pass",
    "later base": "class A(dict[str, int]): pass",
    "pathlib": "from pathlib import Path",
    "typing": "import typing",
    "dataclasses": "import dataclasses",
    "JSON of bytes": "import json\njson.loads(b'1')",
    "JSON of who knows": "import json\ndef f(x): return json.loads(x)",
    "hex with separator": "def f(x): return x.hex(':')",
    "removeprefix": "def f(x): return x.removeprefix('a')",
    "isascii": "def f(x): return x.isascii()",
    "to_bytes with defaults": "def f(x): return x.to_bytes(2)",
    "__set_name__": "class A:\n    def __set_name__(self, owner, name): pass",
    "__init_subclass__": "class A:\n    def __init_subclass__(cls): pass",
    "kwargs in a loop": "def f(**kwargs):\n    for k in kwargs: print(k)",
    "kwargs in a comprehension": "def f(**options): return [v for k, v in options.items()]",
}

OF_THEN = {
    "call with a trailing comma": "def f(*args): pass\nf(*[1],)",
    "plain def with a trailing comma": "def f(a, b,): pass",
    "argument that ends in a comma": "def f(*, a=(1,)): pass",
    "lists with stars": "x = [1, *[2]]\nf = lambda a: {**a}",
    "async without yield": "async def f(a):\n    await a",
    "JSON of text": "import json\ndef f(x): return json.loads(x.decode('utf-8'))",
    "sorted kwargs": "def f(**kwargs):\n    for k in sorted(kwargs): print(k)\n    dict(**kwargs)",
    "hex": "def f(x): return x.hex()",
    "to_bytes": "def f(x): return x.to_bytes(2, 'little')",
    "flags joined": "import stat\ndef f(a): return a & (stat.S_IRWXG | stat.S_IRWXO)",
    "isinstance of a tuple": "isinstance(1, (int, str))",
    "underscored name": "a_1 = 0x1f",
    "continue outside finally": "while True:\n    try: pass\n    finally: pass\n    continue",
}


@pytest.mark.parametrize("source", LATER.values(), ids=LATER)
def test_the_gate_catches(source: str) -> None:
    assert violations(source + "\n")


@pytest.mark.parametrize("source", OF_THEN.values(), ids=OF_THEN)
def test_the_gate_lets_pass(source: str) -> None:
    assert violations(source + "\n") == []


def test_a_violation_tells_its_line() -> None:
    assert violations("x = 1\nimport pathlib\n") == [
        (2, "pathlib: open() and os.path take no Path before 3.6: use os.path")
    ]


@pytest.mark.parametrize("module", modules("robot"), ids=str)
def test_the_robot_is_python_35(module: str) -> None:
    assert violations((ROOT / module).read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("module", [*robot_tests(), "tests/conftest.py", "tests/rig.py"], ids=str)
def test_the_robots_tests_are_python_35(module: str) -> None:
    assert violations((ROOT / module).read_text(encoding="utf-8")) == []
