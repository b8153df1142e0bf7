"""How long a robot may be silent before its link counts as broken."""

from __future__ import annotations


class Silence:
    """For how long nothing has come over a link although the protocol demands that something does.

    The robot answers every request, and sends a record in every tick to who has subscribed. Nothing
    but silence shows that a connection carries nothing any more although nobody has ended it.
    """

    def __init__(self) -> None:
        self._since: float | None = None

    def begin(self) -> None:
        """The robot has been met over a new link, and nothing is due yet."""
        self._since = None

    def ask(self, now: float) -> None:
        """Something was sent at the time `now` (s) that will be answered."""
        if self._since is None:
            self._since = now

    def hear(self, now: float, *, more: bool) -> None:
        """Something has come at the time `now` (s). `more`: whether more is due unasked."""
        self._since = now if more else None

    def lasts(self, now: float) -> float:
        """How long something has been due (s); 0 if nothing is."""
        return 0.0 if self._since is None else now - self._since
