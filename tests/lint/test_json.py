"""No JSON that others cannot read: NaN and the infinities are no JSON."""

import ast

from tests.lint.sources import ROOMS, ROOT, modules


def _writes(tree):
    """The calls that write JSON."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and ast.unparse(node.func) in {"json.dumps", "json.dump"}:
            yield node


def test_json_is_written_without_nan():
    calls = [
        (f"{path}:{call.lineno}", {word.arg: ast.unparse(word.value) for word in call.keywords})
        for path in modules(*ROOMS)
        for call in _writes(ast.parse((ROOT / path).read_text(encoding="utf-8")))
    ]
    assert len(calls) > 10
    assert [place for place, words in calls if words.get("allow_nan") != "False"] == []
