"""A robot whose stream goes to live viewers too."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from host.client.watching import Watcher
from host.lab.live_station import LiveStation
from host.logs.messages import Message, Messages
from host.logs.tap import Event
from robot.record import Record

_CHANGING = ("snapshot", "params", "restart")


class ShownStation(LiveStation):
    """A station that hands its robot's stream on, as the messages that a log holds.

    Attributes:
        publish: Gets each message. It returns at once, since the robot's link calls it.
        on_params: Called when parameters may have changed.
    """

    def __init__(self, *arguments: Any, **named: Any) -> None:
        super().__init__(*arguments, **named)
        self.publish: Callable[[Message], object] = lambda message: None
        self.on_params: Callable[[], object] = lambda: None
        self._messages = Messages(0.0)
        self._snapshot_wanted = False

    def params(self) -> dict[str, Any]:
        """The parameters in force, by name; none before the robot has been found."""
        return dict(self.state().get("params", {}))

    def repeat_snapshot(self) -> None:
        """Have what is in force said as an event before the next record, for who comes late."""
        self._snapshot_wanted = True

    def _meet(self, robot: Watcher) -> None:
        self._messages = Messages(robot.clock_zero_s)
        super()._meet(robot)

    def take_records(self, records: list[Record]) -> None:
        super().take_records(records)
        if records and self._snapshot_wanted:
            self._snapshot_wanted = False
            self._messages.take_event(self._follower.snapshot(records[0].tick))
        for record in records:
            for message in self._messages.take_record(record):
                self.publish(message)

    def take_event(self, event: Event) -> None:
        super().take_event(event)
        self._messages.take_event(event)
        if event["event"] in _CHANGING:
            self.on_params()
