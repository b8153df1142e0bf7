"""One panel of a figure alone, as large as the whole figure.

A module that draws a figure names its panels in PANELS, in the order in which it makes their axes.
Where this depends on the run, axes have their names as labels, and the module may have a function
`panels` that gives the names from the run's options.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import ModuleType
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpec
from matplotlib.legend import Legend

from host.errors import WrongUse


def require_panel(figures: ModuleType, panel: str, options: Mapping[str, Any]) -> None:
    """Raise WrongUse if the figures of a module never have this panel, as far as it knows."""
    of_run = getattr(figures, "panels", None)
    names = of_run(options) if of_run else getattr(figures, "PANELS", ())
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
    _label(figure, axes)
    legends = [*figure.legends, *_legends_alone(figure)]
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
    _keep_legends(figure, axes, legends, others - set(_own(axes)))


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


def _label(figure: Figure, axes: Axes) -> None:
    """Give a panel the labels that stand at another one of its column or row with its limits."""
    axes.tick_params(labelbottom=True, labelleft=True)
    own = axes.get_subplotspec()
    assert own is not None
    for other in figure.axes:
        spec = other.get_subplotspec()
        if spec is None or not other.axison:
            continue
        if spec.colspan == own.colspan and other.get_xlim() == axes.get_xlim():
            axes.set_xlabel(axes.get_xlabel() or other.get_xlabel())
        if spec.rowspan == own.rowspan and other.get_ylim() == axes.get_ylim():
            axes.set_ylabel(axes.get_ylabel() or other.get_ylabel())


def _legends_alone(figure: Figure) -> list[Legend]:
    """The legends that have a place in the grid to themselves."""
    found = [axes.get_legend() for axes in figure.axes if not axes.axison]
    return [legend for legend in found if legend is not None]


def _keep_legends(figure: Figure, axes: Axes, legends: list[Legend], foreign: set[str]) -> None:
    """Leave the panel's entries in legends of all panels, and those that belong to no panel."""
    handles, labels = axes.get_legend_handles_labels()
    own = dict(zip(labels, handles, strict=True))
    for legend in legends:
        texts, title, frame = legend.get_texts(), legend.get_title(), legend.get_frame()
        kept = [
            (own.get(text.get_text(), handle), text.get_text())
            for handle, text in zip(legend.legend_handles, texts, strict=True)
            if text.get_text() not in foreign
        ]
        place: Any = "outside upper center"
        if legend in figure.legends:
            legend.remove()
            place = "outside lower center"
        if kept:
            figure.legend(
                *zip(*kept, strict=True),
                loc=place,
                ncols=4,
                fontsize=texts[0].get_fontsize(),
                labelcolor=texts[0].get_color(),
                frameon=legend.get_frame_on(),
                facecolor=frame.get_facecolor(),
                title=title.get_text(),
                title_fontsize=title.get_fontsize(),
            )
    if handles and axes.get_legend() is None and not figure.legends:
        axes.legend(handles, labels)
