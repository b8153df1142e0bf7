"""One panel of a figure alone, as large as the whole figure.

A module that draws a figure names its panels in PANELS, in the order in which it makes their axes.
Where this depends on the run, axes have their names as labels.
"""

from __future__ import annotations

from types import ModuleType
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpec

from host.errors import WrongUse


def require_panel(figures: ModuleType, panel: str) -> None:
    """Raise WrongUse if the figures of a module never have this panel, as far as it knows."""
    names = getattr(figures, "PANELS", ())
    if names and panel not in names:
        raise _unknown(panel, names)


def keep_panel(figure: Figure, panel: str, names: tuple[str, ...]) -> None:
    """Take all other panels out of a figure, and give the panel their room.

    Args:
        figure: The figure.
        panel: The panel's name.
        names: Those of all panels, in their order; empty if their axes have them as labels.

    Raises:
        WrongUse: The figure has no panel of this name.
    """
    panels = _panels(figure)
    labels = names or [axes.get_label() or number for number, axes in enumerate(panels, start=1)]
    found = {str(label): axes for label, axes in zip(labels, panels, strict=True)}
    if panel not in found:
        raise _unknown(panel, found)
    axes = found[panel]
    others = {str(label) for other in found.values() if other is not axes for label in _own(other)}
    _label(axes)
    twins = [other for other in figure.axes if _spec(other) == _spec(axes)]
    bars = [bar for twin in twins for bar in _bars(twin)]
    for other in list(figure.axes):
        if other not in (*twins, *bars):
            _remove(figure, other)
    whole = GridSpec(1, 1, figure=figure)[0]
    for twin in twins:
        twin.set_subplotspec(whole)
    for bar in bars:
        bar._colorbar_info["parents"] = [axes]  # noqa: SLF001 - so constrained layout finds it
    if axes.get_title() or axes.get_title("left"):
        figure.suptitle("")
    _keep_legends(figure, axes, others - set(_own(axes)))


def _remove(figure: Figure, axes: Axes) -> None:
    """Take a panel out of a figure, also where labels are aligned, which matplotlib forgets."""
    axes.remove()
    for group in getattr(figure, "_align_label_groups", {}).values():
        group.remove(axes)


def _unknown(panel: str, names: Any) -> WrongUse:
    return WrongUse(
        f"this figure has no panel '{panel}'", f"its panels are {', '.join(names) or 'none'}"
    )


def _spec(axes: Axes) -> Any:
    return axes.get_subplotspec()


def _bars(axes: Axes) -> list[Any]:
    return list(getattr(axes, "_colorbars", ()))


def _panels(figure: Figure) -> list[Axes]:
    """The axes of a figure without colour bars, twins, and what only has a legend."""
    found: dict[Any, Axes] = {}
    for axes in figure.axes:
        if not hasattr(axes, "_colorbar") and axes.axison:
            found.setdefault(_spec(axes), axes)
    return list(found.values())


def _own(axes: Axes) -> list[str]:
    return axes.get_legend_handles_labels()[1]


def _label(axes: Axes) -> None:
    """Give a panel the labels of its axes that it shares with others."""
    axes.tick_params(labelbottom=True, labelleft=True)
    for name in ("x", "y"):
        shared = getattr(axes, f"get_shared_{name}_axes")().get_siblings(axes)
        words = [getattr(other, f"get_{name}label")() for other in (axes, *shared)]
        axes.set(**{f"{name}label": next(filter(None, words), "")})


def _keep_legends(figure: Figure, axes: Axes, foreign: set[str]) -> None:
    """Leave the panel's entries in the figure's legends, and those that belong to no panel."""
    handles, labels = axes.get_legend_handles_labels()
    for legend in list(figure.legends):
        words = [text.get_text() for text in legend.get_texts()]
        kept = [
            (handle, word)
            for handle, word in zip(legend.legend_handles, words, strict=True)
            if word not in foreign
        ]
        title = legend.get_title().get_text()
        legend.remove()
        if kept:
            figure.legend(
                *zip(*kept, strict=True), loc="outside lower center", ncols=4, title=title
            )
    if handles and axes.get_legend() is None and not figure.legends:
        axes.legend(handles, labels)
