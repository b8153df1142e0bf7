"""Each kickctl command in README and docs can be typed as it stands there."""

import re
import shlex
from importlib.util import find_spec

import pytest

from host.cli import VERBS, make_parser
from host.commands._parser import join_negative
from host.errors import WrongUse
from tests.package.test_pages import PAGES, ROOT

# What that page adds first, its own test runs: test_contributing.py.
TYPED = [page for page in PAGES if page != "CONTRIBUTING.md"]
BLOCK = re.compile(r"^```\w*\n(.*?)^```", re.DOTALL | re.MULTILINE)
# What a reader puts something else for, as in `kickctl log export LOG`.
PLACEHOLDER = re.compile(r"\b[A-Z]+\b|\.\.\.")


def lines(page):
    """The lines of a page's blocks; one that ends with a backslash goes on."""
    for block in BLOCK.findall((ROOT / page).read_text(encoding="utf-8")):
        yield from block.replace("\\\n", "").splitlines()


def commands(page):
    """The words of each command, without what the shell does with it."""
    for line in lines(page):
        if found := re.match(r"(?:\.venv/bin/)?kickctl ([^#>|;]*)", line):
            yield shlex.split(found[1])


@pytest.mark.parametrize("page", TYPED)
def test_its_commands_can_be_typed(page):
    for words in commands(page):
        verb = next(word for word in words if word in VERBS)
        assert make_parser((verb,)).parse_args(join_negative(words)).verb == verb


@pytest.mark.parametrize("page", [page for page in TYPED if page != "CHANGELOG.md"])
def test_what_its_sentences_name_exists(page):
    """The verb and its options. Without options it may be a name: what it needs is elsewhere."""
    prose = BLOCK.sub("", (ROOT / page).read_text(encoding="utf-8"))
    for line in re.findall(r"`kickctl ([^`>|]*)`", prose):
        words = shlex.split(line)
        if PLACEHOLDER.search(line) or not set(words) & set(VERBS) or words[-1] == "--help":
            continue
        verb = next(word for word in words if word in VERBS)
        try:
            make_parser((verb,)).parse_args(join_negative(words))
        except WrongUse as error:
            assert "arguments are required" in error.message, line
            assert not any(word.startswith("--") for word in words), line


@pytest.mark.parametrize("page", TYPED)
def test_what_make_and_python_are_to_run_is_there(page):
    targets = re.findall(r"^([a-z0-9-]+):", (ROOT / "Makefile").read_text("utf-8"), re.MULTILINE)
    text = (ROOT / page).read_text(encoding="utf-8")
    assert set(re.findall(r"^(?:\w+=\S+ )*make ([\w-]+)", text, re.MULTILINE)) <= {*targets}
    for module in re.findall(r"python3? -m ([\w.]+)", text):
        assert find_spec(module), module


def test_the_first_kick_is_the_kick_of_the_lesson():
    """Which runs as it is written, see tests/cli/test_lesson.py."""
    lesson = (ROOT / "docs/lesson.md").read_text(encoding="utf-8")
    page = (ROOT / "docs/first-kick.md").read_text(encoding="utf-8")
    shared = re.findall(r"^(?:kickctl kick .*?|The kick .*)(?=  +#|$)", page, re.MULTILINE)
    assert len(shared) == 4
    assert [line for line in shared if line not in lesson] == []
