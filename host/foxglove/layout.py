"""A layout for Foxglove and Lichtblick, for live robots and for logs alike.

Both import it from a file. A panel's number in its name only keeps it apart from others.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from host.foxglove.topics import prefixes
from host.logs.messages import EVENTS, NAMED, TICKS
from robot.kicks import WHEELS
from robot.record import CHANNELS

_UNITS = {channel.name: channel.unit for channel in CHANNELS}
_RED = "#d32f2f"
# Titles and channels of the plots over time.
_STRIPS = (
    ("membrane potentials", [f"{side}_{name}" for side in WHEELS for name in ("x1", "x2")]),
    ("relative torque M", [f"{side}_torque" for side in WHEELS]),
    ("wheel angles", [f"{side}_phi_rad" for side in WHEELS]),
    ("how late ticks begin", ["late_s"]),
)
_BUTTONS: tuple[tuple[str, dict[str, Any], str], ...] = (
    ("stop", {}, "STOP"),
    ("start", {}, "start"),
    ("kick", {"mode": "phase", "ticks": 4}, "kick"),
    ("clear", {}, "clear a fault"),
    ("take_over", {}, "take over"),
)


class _Panels:
    """Makes panels, each under a name of its own."""

    def __init__(self) -> None:
        self.configs: dict[str, dict[str, Any]] = {}

    def add(self, kind: str, title: str, config: dict[str, Any]) -> str:
        name = f"{kind}!kick{len(self.configs) + 1}"
        self.configs[name] = {"foxglovePanelTitle": title, **config}
        return name


def make_layout(names: Sequence[str] = ("robot",), *, control: bool = False) -> dict[str, Any]:
    """Make the layout.

    Args:
        names: The robots' names or addresses. With one robot the layout is that of a log, too.
        control: Whether it has buttons and parameters, for `kickctl foxglove --control`.

    Returns:
        What the file holds, plain JSON data.

    Raises:
        WrongUse: Two robots would have the same topics.
    """
    panels = _Panels()
    found = prefixes(names)
    columns = [_robot(panels, name, prefix) for name, prefix in found.items()]
    if control:
        columns.append(_controls(panels, found))
    return {
        "configById": panels.configs,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": _beside(columns, "row"),
    }


def to_text(layout: dict[str, Any]) -> str:
    """The layout as the text of its file."""
    return json.dumps(layout, indent=2, allow_nan=False) + "\n"


def _robot(panels: _Panels, name: str, prefix: str) -> Any:
    """The panels of a robot: what it does over time, planes of its potentials, and its events."""
    topic, mark = prefix + TICKS, f"{name}: " if prefix else ""

    def series(channels: Sequence[str]) -> list[dict[str, Any]]:
        return [
            {
                "value": f"{topic}.{channel}",
                "label": f"{channel} ({_UNITS[channel]})",
                "enabled": True,
                "timestampMethod": "receiveTime",
            }
            for channel in channels
        ]

    strips = [
        panels.add("Plot", mark + title, {**_PLOT, "xAxisVal": "timestamp", "paths": series(which)})
        for title, which in _STRIPS
    ]
    states = panels.add(
        "StateTransitions",
        mark + "state and kick",
        {
            "isSynced": True,
            "paths": [
                {"value": f"{topic}.{channel}", "label": channel, "timestampMethod": "receiveTime"}
                for channel in NAMED
            ],
        },
    )
    planes = [
        panels.add(
            "Plot",
            f"{mark}{side} wheel: x2 over x1",
            {
                **_PLOT,
                "xAxisVal": "custom",
                "xAxisPath": {"value": f"{topic}.{side}_x1", "enabled": True},
                "paths": series([f"{side}_x2"]),
            },
        )
        for side in WHEELS
    ]
    events = panels.add(
        "RawMessages",
        mark + "the latest event",
        {"topicPath": prefix + EVENTS, "diffEnabled": False},
    )
    left = _beside([*strips[:3], states, strips[3]], "column")
    return {
        "direction": "row",
        "first": left,
        "second": _beside([*planes, events], "column"),
        "splitPercentage": 65,
    }


def _controls(panels: _Panels, robots: dict[str, str]) -> Any:
    """Buttons for each robot, the field for the key, and the parameters."""

    def button(service: str, request: dict[str, Any], text: str, *, editing: bool) -> str:
        return panels.add(
            "CallService",
            service,
            {
                "serviceName": service,
                "requestPayload": json.dumps(request, allow_nan=False),
                "layout": "vertical",
                "buttonText": text,
                "buttonTooltip": service,
                "editingMode": editing,
                **({"buttonColor": _RED} if text == "STOP" else {}),
            },
        )

    found = []
    for name, prefix in robots.items():
        mark = f" {name}" if prefix else ""
        found += [
            button(f"{prefix}/{service}", request, text + mark, editing=service == "kick")
            for service, request, text in _BUTTONS
        ]
    found.append(button("/unlock", {"key": ""}, "unlock", editing=True))
    found.append(panels.add("Parameters", "parameters", {}))
    return _beside(found, "column")


def _beside(parts: list[Any], direction: str) -> Any:
    """Parts of equal size beside, or below, each other."""
    first, *others = parts
    if not others:
        return first
    return {
        "direction": direction,
        "first": first,
        "second": _beside(others, direction),
        "splitPercentage": round(100 / len(parts), 1),
    }


_PLOT = {
    "showXAxisLabels": True,
    "showYAxisLabels": True,
    "showLegend": True,
    "legendDisplay": "floating",
    "showPlotValuesInLegend": False,
    "isSynced": True,
    "sidebarDimension": 240,
    "followingViewWidth": 30,
}
