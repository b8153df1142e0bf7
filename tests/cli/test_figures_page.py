"""docs/figures.md: its commands can be typed, and its pictures are what these draw."""

import re
import shlex

import pytest
from PIL import Image

from host.cli import make_parser
from tests.lint.sources import ROOT

PAGE = (ROOT / "docs" / "figures.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| Fig.*?\| `kickctl ([^`]*)` \| (.*) \|$", PAGE, re.MULTILINE)
MOST_BYTES = 150_000


def test_each_figure_of_the_paper_is_there():
    assert {int(number) for number in re.findall(r"^\| Fig\. (\d)", PAGE, re.MULTILINE)} == {
        *range(1, 10)
    }


@pytest.mark.parametrize(("line", "cell"), ROWS, ids=[line for line, _ in ROWS])
def test_a_command_can_be_typed_and_its_picture_is_its_own(line, cell):
    words = shlex.split(line)
    assert make_parser((words[0],)).parse_args(words).verb == words[0]
    if (path := re.search(r'src="([^"]*)"', cell)) is None:
        return
    picture = ROOT / "docs" / path[1]
    assert picture.stat().st_size < MOST_BYTES
    with Image.open(picture) as image:
        assert image.info["Title"] == f"kickctl {line} --seed 1"
