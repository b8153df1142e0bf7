"""The Python 3.5 gate: what in a source text CPython 3.5 would not read or would run differently.

No 3.5 is at hand where the tests run, so three tools look in turn: Python's own grammar of that
version, vermin for modules, functions and arguments that came later, and the rules below for what
those two are known to miss.
"""

import ast
import io
import sys
import tokenize
from collections.abc import Callable, Iterator

import vermin

Violation = tuple[int, str]

# From 3.13 on, the parser knows no grammar older than 3.7; vermin then stands alone for f-strings
# and annotated variables.
GRAMMAR = (3, 5) if sys.version_info < (3, 13) else (3, 7)

BANNED_MODULES = {
    "pathlib": "open() and os.path take no Path before 3.6: use os.path",
    "typing": "its names differ between 3.5.0 and 3.5.4, and robot/ carries no annotations",
    "dataclasses": "is of 3.7: use a class or a namedtuple",
}
LATER_HOOKS = {"__init_subclass__": "3.6", "__set_name__": "3.6", "__class_getitem__": "3.7"}
# Methods that vermin finds on literals only, and from how many arguments on they are too new.
LATER_METHODS = {
    "hex": (1, "3.8"),
    "removeprefix": (0, "3.9"),
    "removesuffix": (0, "3.9"),
    "isascii": (0, "3.7"),
    "bit_count": (0, "3.10"),
}


def violations(source: str) -> list[Violation]:
    """Line and reason of everything in the source that keeps it from Python 3.5, in order.

    Empty if nothing was found.
    """
    try:
        tree = ast.parse(source, feature_version=GRAMMAR)
    except SyntaxError as error:
        return [
            (error.lineno or 0, "not the grammar of Python {}.{}: {}".format(*GRAMMAR, error.msg))
        ]
    found = [violation for node in ast.walk(tree) for rule in RULES for violation in rule(node)]
    found += _tokens(source, tree)
    found += _later_library(source)
    return sorted(set(found))


def _later_library(source: str) -> Iterator[Violation]:
    config = vermin.Config()
    config.add_target("3.5-")
    config.set_only_show_violations(True)
    config.set_eval_annotations(True)
    config.set_verbose(2)
    visitor = vermin.visit(source, config)
    newest = visitor.minimum_versions()[1]
    if newest is not None and newest > (3, 5):
        yield (
            0,
            "vermin: needs Python {}.{}: {}".format(
                *newest, "; ".join(visitor.output_text().split("\n")).strip("; ")
            ),
        )


def _tokens(source: str, tree: ast.Module) -> Iterator[Violation]:
    """What leaves no trace in the tree.

    Underscores in numbers, and a comma after `*args` or keyword-only arguments in a `def`.
    """
    tokens = [
        token
        for token in tokenize.generate_tokens(io.StringIO(source).readline)
        if token.type not in (tokenize.COMMENT, tokenize.NL)
    ]
    for token in tokens:
        if token.type == tokenize.NUMBER and "_" in token.string:
            yield token.start[0], "underscores in numbers are of 3.6"
    defs = (
        node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    )
    starred = {
        (node.lineno, node.col_offset)
        for node in defs
        if node.args.vararg or node.args.kwonlyargs or node.args.kwarg
    }
    for index, token in enumerate(tokens):
        if token.start in starred:
            last = _last_before_closing(tokens, index)
            if last.string == ",":
                yield last.start[0], "a trailing comma after * or ** in a def is of 3.6"


def _last_before_closing(tokens: list[tokenize.TokenInfo], index: int) -> tokenize.TokenInfo:
    """The token before the bracket that closes the first one opened from tokens[index] on."""
    depth = 0
    while True:
        depth += {"(": 1, "[": 1, "{": 1, ")": -1, "]": -1, "}": -1}.get(tokens[index].string, 0)
        if depth == 0 and tokens[index].string == ")":
            return tokens[index - 1]
        index += 1


def _banned_imports(node: ast.AST) -> Iterator[Violation]:
    names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
    if isinstance(node, ast.ImportFrom) and node.module:
        names = [node.module]
    for name in names:
        if name.split(".")[0] in BANNED_MODULES:
            yield node.lineno, "{}: {}".format(name, BANNED_MODULES[name.split(".")[0]])


def _later_hooks(node: ast.AST) -> Iterator[Violation]:
    if isinstance(node, ast.FunctionDef) and node.name in LATER_HOOKS:
        yield node.lineno, f"{node.name} is not called before {LATER_HOOKS[node.name]}"


def _async_generators(node: ast.AST) -> Iterator[Violation]:
    if isinstance(node, ast.AsyncFunctionDef) and any(
        isinstance(inner, ast.Yield) for inner in ast.walk(node)
    ):
        yield node.lineno, "asynchronous generators are of 3.6"


def _bare_stars(node: ast.AST) -> Iterator[Violation]:
    values = {ast.Return: "value", ast.Yield: "value", ast.For: "iter"}
    value = getattr(node, values.get(type(node), ""), None)
    if isinstance(value, ast.Tuple) and any(isinstance(item, ast.Starred) for item in value.elts):
        yield value.lineno, "`return 1, *a` is of 3.8: name the tuple first"


def _later_calls(node: ast.AST) -> Iterator[Violation]:
    if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute):
        return
    name, owner = node.func.attr, node.func.value
    arguments = len(node.args) + len(node.keywords)
    if name in LATER_METHODS and arguments >= LATER_METHODS[name][0]:
        yield node.lineno, f".{name}() with {arguments} arguments is of {LATER_METHODS[name][1]}"
    if name == "to_bytes" and len(node.args) < 2:
        yield node.lineno, ".to_bytes() needs length and byteorder before 3.11"
    if (
        name == "loads"
        and isinstance(owner, ast.Name)
        and owner.id == "json"
        and not _is_text(node.args[:1])
    ):
        yield node.lineno, "json.loads takes no bytes before 3.6: give it x.decode()"


def _annotations(node: ast.AST) -> Iterator[Violation]:
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and (
        node.returns
        or any(isinstance(inner, ast.arg) and inner.annotation for inner in ast.walk(node.args))
    ):
        yield (
            node.lineno,
            (
                "robot/ carries no annotations: 3.5 evaluates them, and knows neither int | str nor"
                " list[int]"
            ),
        )


def _type_unions(node: ast.AST) -> Iterator[Violation]:
    names = ("isinstance", "issubclass")
    if (
        isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and node.func.id in names
        and isinstance(node.args[-1], ast.BinOp)
    ):
        yield node.lineno, "int | str as a type is of 3.10: use a tuple"


def _is_text(arguments: list[ast.expr]) -> bool:
    if (
        arguments
        and isinstance(arguments[0], ast.Call)
        and isinstance(arguments[0].func, ast.Attribute)
    ):
        return arguments[0].func.attr in ("decode", "dumps", "read_text")
    return (
        bool(arguments)
        and isinstance(arguments[0], ast.Constant)
        and isinstance(arguments[0].value, str)
    )


def _keyword_order(node: ast.AST) -> Iterator[Violation]:
    """Loops over **kwargs, whose order is arbitrary before 3.6.

    sorted(kwargs) is not one of them.
    """
    if not isinstance(node, ast.FunctionDef) or node.args.kwarg is None:
        return
    for inner in ast.walk(node):
        if not isinstance(inner, ast.For | ast.comprehension):
            continue
        looped = inner.iter
        if (
            isinstance(looped, ast.Call)
            and isinstance(looped.func, ast.Attribute)
            and looped.func.attr in ("items", "keys", "values")
        ):
            looped = looped.func.value
        if isinstance(looped, ast.Name) and looped.id == node.args.kwarg.arg:
            yield (
                looped.lineno,
                f"**{looped.id} has no order before 3.6: loop over sorted({looped.id})",
            )


RULES: tuple[Callable[[ast.AST], Iterator[Violation]], ...] = (
    _banned_imports,
    _later_hooks,
    _async_generators,
    _bare_stars,
    _later_calls,
    _annotations,
    _type_unions,
    _keyword_order,
)
