"""Draws the figure of a run: which files, which panel, and what its caption says."""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from host.errors import WrongUse
from host.perform.catalogue import BODY, STUDY, Found
from host.runs.contract import Findings, Row, Setting
from host.runs.robot_options import defaults_besides
from host.runs.runner import Draw
from host.theory.studies.registry import K
from host.util.arguments import need_text
from sim_motor.bodies.presets import preset

FORMATS = ("png", "svg", "pdf")
USUAL = ("png", "svg")
# Parameters that experiments set themselves, without an option; None for those that vary.
_SET: dict[str, dict[str, float | None]] = {
    "bifurcation": {"k": None},
    "calibrate": {"a": None, "tau": None, "k": None},
    "explore": {"k": None, "tau": None},
    "exponents": {"k": None, "tau": None},
    "leave-chaos": {"k": 15.0, "tau": 1.0},
}
# The presets of the cars in a figure, where no option names one; the figure says what varies.
_CARS: dict[str, tuple[str, ...]] = {
    "car-slope": ("paper",),
    "train-start": ("paper", "snake2019"),
    "train-wall": ("paper", "snake2019"),
    "train-slope": ("paper", "snake2019"),
    "train-wiggle": ("snake2019",),
    "train-goal": ("snake2019",),
}
# Options that name the constant on an axis.
_AXES = ("along", "over", "x", "y")


class Files(NamedTuple):
    """Which files a figure is written to.

    Attributes:
        figures: The name of the module that draws it.
        formats: Their formats, of FORMATS.
        panel: The one panel that is drawn; None for all.
    """

    figures: str
    formats: tuple[str, ...]
    panel: str | None


def files(
    figures: str,
    formats: str | Sequence[str],
    panel: str | None,
    options: Mapping[str, Any],
) -> Files:
    """Check which files of a figure are wanted.

    Args:
        figures: The name of the module that draws the figure.
        formats: The formats, as a list or as text with commas.
        panel: One panel; None for all.
        options: Those of the run.

    Raises:
        WrongUse: There is no such format, or the figure never has this panel.
    """
    wanted = formats.split(",") if isinstance(formats, str) else list(formats)
    found = tuple(dict.fromkeys(str(one).strip().lower().removeprefix(".") for one in wanted))
    for one in found:
        if one not in FORMATS:
            raise WrongUse(
                f"a figure cannot be written as '{one}'",
                f"there are {', '.join(FORMATS)}; write several with commas: png,pdf",
            )
    if panel is not None:
        from host.figures.panels import require_panel

        need_text("panel", panel, "the name of a panel of the figure")
        require_panel(importlib.import_module(figures), panel, options)
    return Files(figures, found, panel)


def drawing(wanted: Files, found: Found, setting: Setting, settings: Mapping[str, Any]) -> Draw:
    """The function that draws the figure of a run, and writes it.

    Args:
        wanted: Which files to write. matplotlib is imported when the figure is drawn.
        found: The experiment or study.
        setting: What the run's cells share.
        settings: As in the run's settings.json.
    """

    def draw(rows: list[Row], findings: Findings, stem: Path) -> tuple[list[Path], str]:
        from host.figures.caption import of_run
        from host.figures.panels import keep_panel
        from host.figures.style import save

        module = importlib.import_module(wanted.figures)
        figure = module.draw(rows, findings)
        name, panel, other = str(stem), wanted.panel, ""
        if panel is not None:
            try:
                keep_panel(figure, panel, getattr(module, "PANELS", ()))
                name += f"-{panel.replace(' ', '-').replace('/', '-')}"
            except WrongUse as error:
                panel, other = None, f"{error.message}, so all are drawn: {error.hint}"
        caption = of_run(
            "theory" if found.kind == STUDY else "experiment",
            found.entry,
            settings,
            parameters(found, setting, settings["experiment"]),
            panel,
        )
        written = [save(figure, f"{name}.{ending}", caption) for ending in wanted.formats]
        return written, other

    return draw


def parameters(found: Found, setting: Setting, name: str) -> dict[str, Any]:
    """The parameters that a run really had, by the names of options; None for those that vary."""
    options = setting.options
    own = {key: None if isinstance(one, list) else one for key, one in options.items()}
    on_axes = dict.fromkeys(options[axis] for axis in _AXES if axis in options)
    if options.get("along", "k") != "k" and own["k"] is None:
        own["k"] = K.default
    if found.kind == BODY:
        return _of_cars(name, options)
    if found.kind == STUDY:
        return {**own, **on_axes}
    return {**defaults_besides(options), **setting.preset.params, **own, **_SET.get(name, {})}


def _of_cars(name: str, options: Mapping[str, Any]) -> dict[str, Any]:
    """The parameters of the cars of an experiment, as far as they are the same for all it shows."""
    names = (options["preset"],) if "preset" in options else _CARS.get(name, ())
    cars = {one: preset(one) for one in names}
    found: dict[str, Any] = {}
    for letter in ("a", "tau"):
        values = {getattr(car, letter) for car in cars.values()}
        found[letter] = values.pop() if len(values) == 1 else None
    if cars and name != "train-slope":  # which varies k
        several = len(cars) > 1
        found["k"] = ", ".join(f"{car.k:g} N" + f" ({one})" * several for one, car in cars.items())
    return found
