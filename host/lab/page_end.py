"""A page as the session has it: who it is, and what waits to be sent to it."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from host.errors import KickctlError
from host.lab.allowance import Allowance
from host.lab.page_words import for_page

# How many messages a second a page may send, and how many at once. Stops are not counted.
RATE_PER_S, BURST = 150.0, 300.0
# How many messages may wait for a page that reads none.
MAX_WAITING = 400


@dataclass
class Score:
    """How many guesses a page has made, and how many were right.

    For the same kicks: how many the simulation has predicted, and how often what it thought
    likeliest was right.
    """

    guesses: int = 0
    right: int = 0
    predicted: int = 0
    simulation: int = 0


@dataclass(frozen=True)
class Departed:
    """What is kept of a page that is gone, in case it comes back."""

    number: int
    role: str
    score: Score


class Page:
    """A page that has connected.

    Args:
        now: When it came (s).
        local: Whether it is on this computer.

    Attributes:
        number: Its number; 0 before it has joined.
        role: The role that its key gives.
        places: How far it has read the ring of each robot, by the robot's name.
        waiting: The messages that are still to be sent.
        predicts: Whether it waits for a prediction.
        basins: The robot whose basins it wants; empty for none.
        closed: Whether it has been refused or is gone: nothing more comes for it.
        awake: Called when something waits.
    """

    def __init__(self, now: float, local: bool) -> None:
        self.number = 0
        self.role = ""
        self.local = local
        self.since = now
        self.score = Score()
        self.places: dict[str, int] = {}
        self.waiting: deque[dict[str, Any]] = deque()
        self.predicts = False
        self.basins = ""
        self.closed = False
        self.awake: Callable[[], object] = lambda: None
        self.allowance = Allowance(now, RATE_PER_S, BURST)

    def send(self, message: dict[str, Any]) -> None:
        """Have a message sent. A page that takes none for too long is closed."""
        if self.closed:
            return
        if len(self.waiting) >= MAX_WAITING:
            self.waiting.clear()
            self.closed = True
        else:
            self.waiting.append(message)
        self.awake()

    def answer(self, request: int | None, result: dict[str, Any] | KickctlError) -> None:
        """Answer a request; an error without one becomes a note."""
        if isinstance(result, KickctlError):
            words = {"message": for_page(result.message), "hint": for_page(result.hint)}
            if request is None:
                self.send({"type": "note", **words})
            else:
                self.send({"type": "reply", "request": request, "error": words})
        elif request is not None:
            self.send({"type": "reply", "request": request, "result": result})

    def refuse(self, message: str, hint: str) -> None:
        """Say why this page cannot stay, and let it go."""
        self.send({"type": "refused", "message": message, "hint": hint})
        self.closed = True

    def departed(self) -> Departed:
        """What is to be kept when it goes."""
        return Departed(self.number, self.role, self.score)

    def resume(self, before: Departed) -> None:
        """It is a page that was here before."""
        self.number, self.role, self.score = before.number, before.role, before.score
