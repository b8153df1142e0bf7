"""Figures that are quick to draw, or none, for tests whose subject they are not."""

from contextlib import contextmanager
from pathlib import Path

import pytest

from host.figures import style


@contextmanager
def small_figures():
    """Figures are small and not laid out within the context."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(style.SIZE, "dpi", 40)
        patch.setitem(style.SIZE, "layout", None)
        yield


def without_figures(folder):
    """The PYTHONPATH of a kickctl that can draw nothing, for which a folder is needed.

    To load matplotlib and to draw a figure takes four times as long as all else of a kick.
    """
    hidden = folder / "no-matplotlib"
    hidden.mkdir(exist_ok=True)
    (hidden / "matplotlib.py").write_text("raise ImportError('not installed')\n", encoding="utf-8")
    return f"{hidden}:{Path(__file__).parents[1]}"
