"""No JSON that others cannot read: NaN and the infinities are no JSON."""

import ast

from tests.lint.sources import ROOMS, ROOT, modules


def _writes(source):
    """The calls that write JSON."""
    if "json.dump" not in source:  # which takes far less time to see than to parse
        return
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Call) and ast.unparse(node.func) in {"json.dumps", "json.dump"}:
            yield node


def test_json_is_written_without_nan():
    calls = [
        (f"{path}:{call.lineno}", {word.arg: ast.unparse(word.value) for word in call.keywords})
        for path in modules(*ROOMS)
        for call in _writes((ROOT / path).read_text(encoding="utf-8"))
    ]
    assert len(calls) > 10
    assert [place for place, words in calls if words.get("allow_nan") != "False"] == []
