"""Figures that are quick to draw, for tests whose subject they are not."""

from contextlib import contextmanager

import pytest

from host.figures import style


@contextmanager
def small_figures():
    """Figures are small and not laid out within the context."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(style.SIZE, "dpi", 40)
        patch.setitem(style.SIZE, "layout", None)
        yield
