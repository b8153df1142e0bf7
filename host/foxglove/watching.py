"""Who watches what: the subscriptions of all viewers."""

from __future__ import annotations

import threading
from collections.abc import Set as AbstractSet

from foxglove.websocket import ChannelView, Client, ServerListener


class Watching(ServerListener):
    """A listener of the SDK's server that keeps subscriptions. Its threads call it."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._subscriptions: set[tuple[int, str]] = set()
        self._new: set[str] = set()

    def on_subscribe(self, client: Client, channel: ChannelView) -> None:
        with self._lock:
            self._subscriptions.add((client.id, channel.topic))
            self._new.add(channel.topic)

    def on_unsubscribe(self, client: Client, channel: ChannelView) -> None:
        with self._lock:
            self._subscriptions.discard((client.id, channel.topic))

    def watches(self, client: int, topic: str) -> bool:
        """Whether a viewer watches a topic."""
        return (client, topic) in self._subscriptions

    def topics_of(self, clients: AbstractSet[int]) -> set[str]:
        """The topics that some of these viewers watch."""
        with self._lock:
            return {topic for client, topic in self._subscriptions if client in clients}

    def take_new(self) -> set[str]:
        """The topics to which somebody has subscribed since the last call."""
        with self._lock:
            new, self._new = self._new, set()
        return new
