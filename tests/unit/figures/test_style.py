"""How all figures are written: what they say about their run, one panel alone, the same bytes."""

import re

import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text
from PIL import Image

from host.errors import WrongUse
from host.figures.caption import Caption, in_words, of_run
from host.figures.panels import keep_panel
from host.figures.style import SIZE, save, styled
from host.perform.drawings import FORMATS
from host.runs.registry import Entry, Option
from robot import __version__

CAPTION = Caption("k = 8   seed 1", "kickctl theory hopf --k 8")


def pictures():
    """Four panels with a shared axis, a colour bar, and a legend for the two upper ones."""
    with styled():
        figure = Figure(**SIZE)
        (left, right), (map_, lines) = figure.subplots(2, 2, sharey="row")
        left.plot([0, 1], [1, 2], label="both")
        left.set(ylabel="speed (rad/s)", title="left")
        right.plot([0, 1], [2, 1], label="right alone")
        figure.colorbar(map_.pcolormesh([[0, 1], [2, 3]]), ax=map_)
        figure.legend(*right.get_legend_handles_labels(), loc="outside lower center")
        lines.plot([0, 1], [0, 1])
        figure.suptitle("all of them")
    return figure


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """A folder with the same drawing, drawn twice, in files of all formats: a.png and b.png."""
    folder = tmp_path_factory.mktemp("saved")
    for name in "ab":
        figure = pictures()
        for ending in FORMATS:
            save(figure, folder / f"{name}.{ending}", CAPTION)
    return folder


@pytest.mark.parametrize("ending", FORMATS)
def test_the_same_drawing_is_the_same_file_and_says_what_it_shows(saved, ending):
    first, second = ((saved / f"{name}.{ending}").read_bytes() for name in "ab")
    assert first == second
    if ending == "png":
        with Image.open(saved / "a.png") as image:
            assert image.size == (1920, 1080)
            assert image.info["Title"] == CAPTION.command
            assert image.info["Description"] == CAPTION.parameters
            assert image.info["Software"] == f"kickctl {__version__}"
    elif ending == "svg":
        text = first.decode()
        assert CAPTION.command in text
        assert __version__ in text
        assert re.search("<text[^>]*>k = 8   seed 1</text>", text)
        assert "dc:date" not in text
    else:
        assert CAPTION.command.encode() in first
        assert CAPTION.parameters.encode() in first
        assert b"CreationDate" not in first


class CountedText(Text):
    """A text that counts how often it is drawn."""

    drawn = 0

    def draw(self, renderer):
        self.drawn += 1
        super().draw(renderer)


def test_each_file_is_drawn_once(tmp_path):
    figure = pictures()
    text = figure.add_artist(CountedText(0.5, 0.5, "x"))
    for ending in ("png", "svg"):
        save(figure, tmp_path / f"figure.{ending}", CAPTION)
    assert text.drawn == 2


def test_a_panel_alone_has_the_whole_figure_and_what_it_shared_with_others():
    figure = pictures()
    keep_panel(figure, "right", ("left", "right", "map", "lines"))
    figure.draw_without_rendering()
    (axes,) = figure.axes
    assert axes.get_position().width > 0.8
    assert axes.get_ylabel() == "speed (rad/s)"
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["right alone"]
    figure = pictures()
    keep_panel(figure, "map", ("left", "right", "map", "lines"))
    figure.draw_without_rendering()
    assert len(figure.axes) == 2
    assert figure.axes[0].get_position().width > 0.7
    assert figure.legends == []


def test_an_unknown_panel_is_refused_with_the_names_of_all():
    with pytest.raises(WrongUse, match="no panel 'x'") as caught:
        keep_panel(pictures(), "x", ())
    assert caught.value.hint == "its panels are 1, 2, 3, 4"


def test_the_corner_has_what_is_not_ordinary_and_nothing_that_varies():
    assert in_words({"k": None, "tau": 0.25, "rods": 2, "bounded": None, "trials": 50}) == (
        "τ = 0.25 s"
    )
    assert in_words({"a": 4, "rods": 1, "bounded": 1.0}) == "a = 4   rods: 1   M_max = 1"


def test_a_caption_has_the_command_with_what_was_chosen():
    options = (
        Option("k", 8.0, 0.0, 100.0, "k"),
        Option("tau", 0.25, 0.0, 9.0, "tau, s"),
        Option("preset", "ordinary", 0, 0, "which", ("ordinary", "paper")),
    )
    settings = {
        "experiment": "timeline",
        "options": {"k": [2.0, 4.0], "tau": 0.25, "preset": "paper"},
        "seed": 3,
        "brick": "sim://?motor=mine&seed=3",
    }
    caption = of_run("experiment", Entry("", options), settings, {"k": None, "tau": 0.25}, "series")
    assert caption.parameters == "τ = 0.25 s   seed 3   preset paper   motor mine"
    assert caption.command == (
        "kickctl experiment timeline --k 2.0,4.0 --preset paper --seed 3"
        " --brick 'sim://?motor=mine&seed=3' --panel series"
    )
