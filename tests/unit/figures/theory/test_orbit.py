"""The figure of the study `orbit`."""

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

from host.figures.theory.orbit import draw
from host.runs.contract import Setting
from host.runs.registry import complete_options
from host.theory.studies.orbit_report import report
from host.theory.studies.registry import TABLE


@pytest.fixture
def figure():
    """A short window of swings at the left, and a long one of rolling."""
    kinds = ["forth-and-back"] * 6 + ["rolling"] * 74
    rows = [
        {
            "way": way,
            "first": 0,
            "value": 0.1 + 0.01 * number,
            "number": 0,
            "kind": kind,
            "period": 1,
            "period_s": 2.0,
            "exponent": None,
            "section_x2": 0.0,
            "section_phi": 0.0,
            "section_omega": 1.0,
        }
        for way in ("up", "down")
        for number, kind in enumerate(kinds)
    ]
    options = complete_options("orbit", TABLE["orbit"], {"over": "tau"})
    found = draw(rows, report(rows, Setting(1, options)))
    FigureCanvasAgg(found).draw()
    return found


def test_periods_of_windows_do_not_stand_on_the_panels_titles(figure):
    for axes in figure.axes:
        words = axes.findobj(Text)
        (own,) = (text for text in words if text.get_text() == axes.get_title("left"))
        title = own.get_window_extent()
        periods = [text for text in axes.texts if text.get_text() == "1"]
        assert len(periods) == 2
        for period in periods:
            assert not title.overlaps(period.get_window_extent())
