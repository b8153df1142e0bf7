"""python3 -m robot.compile: what deploy prepares, so that a start and a tick take less time.

It keeps the fingerprint of the sources, and the byte code of this folder, in which Wheel.step calls
no equation: CPython 3.5 takes longer for a call than for what most equations compute. So the
functions of robot/controller.py stand in robot/wheel.py where they are called, as a compiler of C
does it: the same operations in the same order give the same numbers to the last bit. The result is
the usual byte code file of wheel.py. Python compiles wheel.py as it is if the file is gone or
wheel.py changes, and the file itself ends the program if controller.py changes.
"""

import ast
import compileall
import os
import sys
from copy import deepcopy
from importlib.machinery import SourceFileLoader
from importlib.util import cache_from_source

from robot.sources import keep

FOLDER = os.path.dirname(os.path.abspath(__file__))
# What comes after wheel.py's docstring: Python itself looks at wheel.py alone.
_GUARD = """
import os
import robot.controller
_source = os.stat(robot.controller.__file__)
if (_source.st_size, int(_source.st_mtime)) != {}:
    raise SystemExit(
        "robot/controller.py has changed, and Wheel.step contains it as it was: run"
        " `python3 -m robot.compile`, then start again"
    )
"""


class _Rename(ast.NodeTransformer):
    """Puts values, nodes by name, in the place of names, and all of it where `place` is."""

    def __init__(self, values, place):
        self._values = values
        self._place = place

    def visit(self, node):
        node = super(_Rename, self).visit(node)
        return ast.copy_location(node, self._place)

    def visit_Name(self, node):
        value = self._values.get(node.id, node)
        return ast.Name(value.id, node.ctx) if isinstance(value, ast.Name) else value


class _Inline(ast.NodeTransformer):
    """Puts functions in the place of their calls; `functions` are ast.FunctionDef by name."""

    def __init__(self):
        self.functions = {}

    def visit_Call(self, node):
        """A call of a function that only returns a value becomes this value."""
        self.generic_visit(node)
        parameters, body = self._look_up(node)
        if len(body) != 1:
            return node
        names = [name.id for name in ast.walk(body[0]) if isinstance(name, ast.Name)]
        for parameter, argument in zip(parameters, node.args):
            if names.count(parameter) > 1 and not isinstance(argument, ast.Name):
                return node  # or the argument would be computed twice
        return _Rename(dict(zip(parameters, node.args)), node).visit(deepcopy(body[0].value))

    def visit_Assign(self, node):
        """An assignment of what a longer function returns becomes this function's statements."""
        self.generic_visit(node)
        parameters, body = self._look_up(node.value)
        if not body:
            return node
        stored = [
            name.id
            for statement in body
            for name in ast.walk(statement)
            if isinstance(name, ast.Name) and isinstance(name.ctx, ast.Store)
        ]
        prefix = node.value.func.id + "_"
        values = {name: ast.Name(prefix + name, ast.Load()) for name in parameters + stored}
        statements = [
            ast.copy_location(ast.Assign([ast.Name(prefix + name, ast.Store())], argument), node)
            for name, argument in zip(parameters, node.value.args)
        ]
        statements += [_Rename(values, node).visit(deepcopy(each)) for each in body[:-1]]
        node.value = _Rename(values, node).visit(deepcopy(body[-1].value))
        return statements + [node]

    def _look_up(self, node):
        """(names of the parameters, statements) of a function that a node calls, else empty."""
        called = node.func if isinstance(node, ast.Call) else None
        function = self.functions.get(called.id) if isinstance(called, ast.Name) else None
        if function is None:
            return [], []
        return [each.arg for each in function.args.args], function.body[1:]  # [0]: its docstring


def inline(equations, caller):
    """Put functions of one module into another one.

    Args:
        equations: The source of a module of pure functions, each below those that it calls. Each
            has a docstring, and returns only at its end.
        caller: The source of a module that calls them by the same names.

    Returns:
        The other module as an ast.Module, ready for `compile`.
    """
    inliner = _Inline()
    imports = []
    for node in ast.parse(equations).body:
        if isinstance(node, ast.FunctionDef):
            inliner.functions[node.name] = inliner.visit(node)
        elif isinstance(node, ast.ImportFrom):
            imports.append(node)
    module = inliner.visit(ast.parse(caller))
    module.body[1:1] = imports  # [0]: its docstring
    return ast.fix_missing_locations(module)


class _Loader(SourceFileLoader):
    """Compiles wheel.py with controller.py's functions in it, and keeps the result."""

    def source_to_code(self, data, path, **options):  # type: ignore[override]
        with open(os.path.join(FOLDER, "controller.py"), "rb") as file:
            there = os.fstat(file.fileno())
            module = inline(file.read(), data)
        guard = _GUARD.format((there.st_size, int(there.st_mtime)))
        module.body[1:1] = ast.parse(guard).body
        return compile(module, path, "exec", dont_inherit=True)


def main():
    """Compile everything, and keep the fingerprint.

    Returns:
        The exit status: 0, or 1 if something cannot be compiled.
    """
    if not compileall.compile_dir(FOLDER, quiet=1):
        return 1
    path = os.path.join(FOLDER, "wheel.py")
    os.remove(cache_from_source(path))  # or it would be taken as it is
    sys.dont_write_bytecode = False
    _Loader("robot.wheel", path).get_code("robot.wheel")
    keep()
    return 0


if __name__ == "__main__":
    sys.exit(main())
