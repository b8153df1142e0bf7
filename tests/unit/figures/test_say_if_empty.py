"""A panel without data says why it has none."""

import numpy as np
from matplotlib.figure import Figure

from host.figures.style import say_if_empty


def test_only_a_panel_without_data_says_why():
    empty, unknown, line, dots = Figure().subplots(1, 4)
    unknown.plot([1.0, 2.0], [np.nan, np.nan])
    line.plot([1.0, 2.0], [0.0, 1.0])
    dots.scatter([1.0], [2.0])
    for axes in (empty, unknown, line, dots):
        say_if_empty(axes, "why")
    assert [[text.get_text() for text in axes.texts] for axes in (empty, unknown, line, dots)] == [
        ["why"],
        ["why"],
        [],
        [],
    ]
