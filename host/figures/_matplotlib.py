"""Load matplotlib, no matter what the user's settings for it say.

matplotlib reads its settings while it is imported, and cannot be imported if they are damaged or
name a backend that is not there. Figures need none of them.
"""

from __future__ import annotations

import logging
import os
import sys
from collections.abc import Iterator
from contextlib import chdir, contextmanager, nullcontext, suppress
from importlib.util import find_spec
from pathlib import Path

_NAMES = ("MPLBACKEND", "MATPLOTLIBRC")


def load() -> None:
    """Import matplotlib with its own defaults, and give it the user's settings where they work.

    So a notebook that imports matplotlib later finds its settings and its backend. Where it has
    imported matplotlib already, nothing happens.
    """
    spec = find_spec("matplotlib")
    if "matplotlib" in sys.modules or spec is None or spec.origin is None:
        return
    folder = Path(spec.origin).parent / "mpl-data"
    with _defaults(folder):
        import matplotlib as mpl
    logger = logging.getLogger("matplotlib")
    before, logger.disabled = logger.disabled, True  # it complains of damage
    try:
        # What damaged settings can raise is up to them.
        with suppress(Exception):
            mpl.rcParams.update(mpl.rc_params_from_file(mpl.matplotlib_fname(), False, False))
        if os.environ.get("MPLBACKEND"):
            with suppress(ValueError):
                mpl.rcParams["backend"] = os.environ["MPLBACKEND"]
    finally:
        logger.disabled = before


@contextmanager
def _defaults(folder: Path) -> Iterator[None]:
    """Have matplotlib read the settings in this folder, and none in the working folder."""
    before = {name: os.environ.pop(name, None) for name in _NAMES}
    os.environ["MATPLOTLIBRC"] = str(folder)
    try:
        with chdir(folder) if Path("matplotlibrc").exists() else nullcontext():
            yield
    finally:
        for name, value in before.items():
            os.environ.pop(name, None)
            if value is not None:
                os.environ[name] = value
