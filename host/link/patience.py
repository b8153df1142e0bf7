"""How long to wait for a robot's answer."""

from __future__ import annotations

from host.link.transport import Link


class Patience:
    """The time that a robot may take for an answer, from now on.

    ssh has to log in first, and a person may have to type a password for that. Such a link has
    `answer_s`, the time for both, and `logged_in`: from the login on, a robot there may take no
    longer than any other.

    Args:
        link: The way to the robot, which is open.
        seconds: How long the robot may take (s).
    """

    def __init__(self, link: Link, seconds: float) -> None:
        self._link = link
        self._seconds = seconds
        self._counts = not hasattr(link, "logged_in")
        self._until = link.now() + (
            seconds if self._counts else float(getattr(link, "answer_s", seconds))
        )

    def is_over(self) -> bool:
        """Whether the time is over."""
        now = self._link.now()
        if not self._counts and self._link.logged_in():  # type: ignore[attr-defined]
            self._counts = True
            self._until = min(self._until, now + self._seconds)
        return now > self._until
