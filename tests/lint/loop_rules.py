"""What the robot's program may not do: it would delay a tick, or end in a foreign locale.

Once the loop runs, nothing is imported and no program is started; and words go out through `say`,
which no locale can break. tests/sysfs/test_warm.py shows the first for every request.
"""

import ast
from collections.abc import Iterator

# Functions that may import: they run before the loop does.
BEFORE_THE_LOOP = {
    ("robot/__main__.py", "_drive_brick"),
    ("robot/__main__.py", "_drive_own"),
    ("robot/arguments.py", "_help"),
    ("robot/program.py", "_attach"),
    ("robot/schedule.py", "lock_memory"),
    ("robot/serial_line.py", "__init__"),
}
STARTERS = {"platform", "subprocess", "multiprocessing"}  # `platform` runs uname on Python 3.5
STARTING_CALLS = {"fork", "forkpty", "popen", "system"}
MAY_FORK = "robot/watchdog.py"  # before the loop, and before anything is open
MAY_PRINT = ("robot/words.py", "say")


def violations(path: str, source: str) -> list[tuple[int, str]]:
    """Line and reason of everything in a source of robot/ that breaks these rules, in order."""
    return sorted(set(_look(path, "", ast.parse(source))))


def _look(path: str, function: str, node: ast.AST) -> Iterator[tuple[int, str]]:
    for child in ast.iter_child_nodes(node):
        inside = child.name if isinstance(child, ast.FunctionDef) else function
        yield from _imports(path, inside, child)
        yield from _calls(path, inside, child)
        yield from _look(path, inside, child)


def _imports(path: str, function: str, node: ast.AST) -> Iterator[tuple[int, str]]:
    if not isinstance(node, ast.Import | ast.ImportFrom):
        return
    if function and (path, function) not in BEFORE_THE_LOOP:
        yield node.lineno, f"{function} imports: a tick would wait for it; import at the top"
    names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else [node.module]
    for name in names:
        if name in STARTERS:
            yield node.lineno, f"{name} starts programs, which takes longer than a tick"


def _calls(path: str, function: str, node: ast.AST) -> Iterator[tuple[int, str]]:
    if not isinstance(node, ast.Call):
        return
    if isinstance(node.func, ast.Attribute):
        name = node.func.attr
        if name in STARTING_CALLS and path != MAY_FORK:
            yield node.lineno, f"{name} starts a process, which takes longer than a tick"
        if name == "write" and ast.unparse(node.func.value) in ("sys.stdout", "sys.stderr"):
            yield node.lineno, "a locale may not know a letter of it: use robot.words.say"
        if name == "isprintable":
            yield node.lineno, "Python 3.5 knows no letter that is younger than 2015"
    elif isinstance(node.func, ast.Name):
        if node.func.id == "print" and (path, function) != MAY_PRINT:
            yield node.lineno, "a locale may not know a letter of it: use robot.words.say"
        if node.func.id == "open" and _reads_text(node):
            yield node.lineno, "the locale would decide what the bytes mean: name the encoding"


def _reads_text(call: ast.Call) -> bool:
    mode = ast.unparse(call.args[1]) if len(call.args) > 1 else "'r'"
    return "b" not in mode and not any(word.arg == "encoding" for word in call.keywords)
