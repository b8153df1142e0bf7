"""docs/pictures/rooms.svg has the rooms and floors of pyproject.toml, from top to bottom."""

import re
import tomllib

from tests.lint.sources import ROOT

TEXTS = re.findall(
    r"<text(?: class=\"(\w+)\")?[^>]* y=\"([\d.]+)\"[^>]*>([^<]*)<",
    (ROOT / "docs" / "pictures" / "rooms.svg").read_text(encoding="utf-8"),
)


def drawn(kind):
    """The names of a class, from top to bottom."""
    rows = [(float(y), name) for found, y, name in TEXTS if found == kind]
    return [name for _, name in sorted(rows)]


def test_rooms_and_floors_are_those_that_lint_keeps_apart():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    rooms, floors, _ = project["tool"]["importlinter"]["contracts"]
    assert drawn("room") == rooms["layers"]
    assert drawn("floor") == floors["layers"]


def test_the_modules_on_the_way_of_a_tick_are_there():
    modules = {word for _, _, text in TEXTS for word in re.findall(r"\w+\.py", text)}
    assert len(modules) >= 7
    assert {name for name in modules if not (ROOT / "robot" / name).is_file()} == set()
