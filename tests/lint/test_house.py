"""The rules of the house that no linter knows.

Who may import whom, where the equations stand, how long a file may be.
"""

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from graphlib import TopologicalSorter

import pytest

from tests.lint.sources import ROOMS, ROOT, modules, scripts

# Which rooms, and which packages besides, a room may import; None leaves the packages open.
MAY_IMPORT = {
    "robot": ({"robot"}, {"ev3dev2", "serial"}),
    "sim_motor": ({"robot", "sim_motor"}, None),
    "host": ({"robot", "sim_motor", "host"}, None),
    "kickctl": ({"host", "kickctl"}, None),
}
LONGEST_FILE, LONGEST_LINE = 400, 100
# In pieces, so that this file does not name them either.
REGISTRIES = [
    ".".join(name)
    for name in (
        ("pypi", "org"),
        ("pythonhosted", "org"),
        ("npmjs", "org"),
        ("deb", "debian", "org"),
    )
]
HEAVY = {"matplotlib", "mcap", "numba", "numpy", "rich", "scipy"}


def imported_modules(source: str) -> set[str]:
    """The modules that a source imports or takes names from, at its top or anywhere else.

    Relative imports stay in the room.
    """
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            found.add(str(node.module))
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def imported(source: str) -> set[str]:
    """The top-level packages that a source imports."""
    return {name.split(".")[0] for name in imported_modules(source)}


def strangers(room: str, source: str) -> set[str]:
    """What a source in the room imports and may not."""
    rooms, packages = MAY_IMPORT[room]
    others = imported(source) - rooms - sys.stdlib_module_names
    return others & {*ROOMS, "tests"} if packages is None else others - packages


def restated_equations(source: str) -> Iterator[tuple[int, str]]:
    """Line and kind of every tanh or logistic function in a source, under any imported name."""
    if not re.search(r"\b(tanh|exp|expit)\b", source):  # far faster than to parse
        return
    tree = ast.parse(source)
    imports = (node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom))
    known_as = {alias.asname or alias.name: alias.name for node in imports for alias in node.names}

    def called(node: ast.AST) -> str:
        if isinstance(node, ast.Attribute):
            return node.attr
        return known_as.get(node.id, node.id) if isinstance(node, ast.Name) else ""

    for node in ast.walk(tree):
        if called(node) in ("tanh", "expit"):
            yield node.lineno, called(node)
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
            ends = (node.left, node.right)
            if any(isinstance(end, ast.Constant) and end.value == 1 for end in ends) and any(
                isinstance(end, ast.Call) and called(end.func) == "exp" for end in ends
            ):
                yield node.lineno, "1 + exp"


def test_no_modules_import_each_other_in_a_circle() -> None:
    files = {
        path.removesuffix(".py").removesuffix("/__init__").replace("/", "."): path
        for path in modules(*ROOMS)
    }
    arrows = {
        name: imported_modules((ROOT / path).read_text(encoding="utf-8")) & set(files) - {name}
        for name, path in files.items()
    }
    assert arrows["host.logs.log"] >= {
        "host.logs.mcap_files",
        "robot.record",
    }  # it sees imports within functions too
    TopologicalSorter(arrows).prepare()  # raises CycleError, which names the circle


@pytest.mark.parametrize("module", modules(*ROOMS), ids=str)
def test_a_room_imports_only_what_it_may_know(module: str) -> None:
    assert strangers(module.partition("/")[0], (ROOT / module).read_text(encoding="utf-8")) == set()


@pytest.mark.parametrize(
    ("room", "source", "expected"),
    [
        ("robot", "def f():\n    import numpy.linalg", {"numpy"}),
        ("robot", "from sim_motor import motor", {"sim_motor"}),
        (
            "robot",
            (
                "import os, serial\nfrom ev3dev2.motor import LargeMotor\nfrom . import wire\nfrom"
                " robot import wire"
            ),
            set(),
        ),
        ("sim_motor", "import numba\nfrom host import api", {"host"}),
        ("host", "import tests.unit, rich, sim_motor", {"tests"}),
    ],
)
def test_strangers_are_found(room: str, source: str, expected: set[str]) -> None:
    assert strangers(room, source) == expected


@pytest.mark.parametrize(
    "module", [module for module in modules(*ROOMS) if module != "robot/controller.py"], ids=str
)
def test_the_papers_equations_stand_only_in_the_controller(module: str) -> None:
    assert list(restated_equations((ROOT / module).read_text(encoding="utf-8"))) == []


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("import numpy as n\ny = n.tanh(1)", ["tanh"]),
        ("from math import tanh as t\ny = t(1)", ["tanh"]),
        ("from math import exp as e\ny = 1 / (1 + e(-4 * 2))", ["1 + exp"]),
        ("import math\ny = 1.0 / (math.exp(-2) + 1.0)", ["1 + exp"]),
        ("from scipy.special import expit\ny = expit(1)", ["expit"]),
        ("import math\ny = 2 * (1 - math.exp(-0.1)) + math.exp(1)", []),
    ],
)
def test_a_second_copy_of_an_equation_is_found(source: str, expected: list[str]) -> None:
    assert [kind for _, kind in restated_equations(source)] == expected


def test_the_controller_itself_would_be_found() -> None:
    kinds = {
        kind
        for _, kind in restated_equations(
            (ROOT / "robot/controller.py").read_text(encoding="utf-8")
        )
    }
    assert kinds == {"tanh", "1 + exp"}


@pytest.mark.parametrize("file", [*modules(*ROOMS, "tests"), *scripts()], ids=str)
def test_no_file_is_too_long_to_read(file: str) -> None:
    assert len((ROOT / file).read_text(encoding="utf-8").splitlines()) <= LONGEST_FILE


# ruff sees to those of Python.
@pytest.mark.parametrize("file", scripts(), ids=str)
def test_no_line_of_a_script_is_too_long_to_read(file: str) -> None:
    lines = (ROOT / file).read_text(encoding="utf-8").expandtabs(4).splitlines()
    assert [line for line in lines if len(line) > LONGEST_LINE] == []


def test_no_file_names_a_package_registry() -> None:
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    files = [ROOT / name for name in listed.stdout.split("\0") if name and (ROOT / name).is_file()]
    assert ROOT / "requirements.lock" in files
    named = [
        (str(path.relative_to(ROOT)), host)
        for path in files
        for host in REGISTRIES
        if host.encode() in path.read_bytes()
    ]
    assert named == []


@pytest.mark.skipif(not (ROOT / "host" / "cli.py").exists(), reason="there is no command line yet")
def test_help_loads_nothing_heavy() -> None:
    help_then_modules = (
        "import contextlib, sys\nfrom host.cli import main\nsys.argv = ['kickctl', '--help']\n"
        "with contextlib.suppress(SystemExit):\n    main()\nprint(*sys.modules, file=sys.stderr)"
    )
    done = subprocess.run(
        [sys.executable, "-c", help_then_modules],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    assert "kickctl" in done.stdout
    assert HEAVY & set(done.stderr.split()) == set()
