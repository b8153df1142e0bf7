"""The baton: at most one page drives, and whoever waits for it is never left without a way on."""

from __future__ import annotations

from host.errors import NotDone, RefusedByRobot
from host.lab.keys import DRIVE

# A driver's page that has been silent for so long is not awake (s).
SILENT_S = 1.0


class Baton:
    """Who drives, who asks to, and why it last changed hands. Pages are numbers.

    Attributes:
        driver: The page that drives; None if nobody does.
        asking: The pages that ask for the baton, in the order in which they asked.
        why: Why the driver is who it is, as a sentence; may be empty.
        changed: Whether pages have to be told.
    """

    def __init__(self) -> None:
        self.driver: int | None = None
        self.asking: list[int] = []
        self.why = ""
        self.changed = False
        self._heard_at = 0.0

    def ask(self, page: int, role: str, now: float) -> None:
        """A page asks. A free baton goes to a page that may drive at once."""
        if self.driver == page:
            return
        if self.driver is None and role == DRIVE:
            self._hand_to(page, now)
        elif page not in self.asking:
            self.asking.append(page)
            self.changed = True

    def need(self, page: int, role: str, now: float) -> None:
        """Require that a page drives, for which a free baton goes to one that may.

        Raises:
            RefusedByRobot: Another page drives, or this one may only watch.
        """
        if self.driver == page:
            self.beat(page, now)
            return
        if self.driver is not None:
            raise RefusedByRobot(
                f"page {self.driver} drives the robots", "ask for the baton. Anyone may stop"
            )
        if role != DRIVE:
            raise RefusedByRobot(
                "nobody drives the robots, and this page may only watch",
                "ask for the baton: a page with the drive key can give it to you",
            )
        self._hand_to(page, now)

    def take(self, page: int, role: str, now: float) -> None:
        """A page with the drive key takes the baton, also from the driver.

        Raises:
            RefusedByRobot: The page may only watch.
        """
        if role != DRIVE:
            raise RefusedByRobot(
                "only a page with the drive key takes the baton", "ask for the baton instead"
            )
        if self.driver != page:
            whence = "" if self.driver is None else f" from page {self.driver}"
            self._hand_to(page, now, f"page {page} has taken the baton{whence}")

    def give(self, page: int, role: str, to: int, now: float) -> None:
        """Hand the baton to a page that asks: the driver, or a page that could take it.

        Raises:
            RefusedByRobot: The page neither drives nor has the drive key.
            NotDone: The other one does not ask.
        """
        if self.driver != page and role != DRIVE:
            raise RefusedByRobot(
                "this page does not drive", "a page with the drive key can hand over the baton"
            )
        if to not in self.asking:
            raise NotDone(f"page {to} does not ask for the baton", "it may have left")
        self._hand_to(to, now, f"page {page} has given the baton to page {to}")

    def leave(self, page: int) -> None:
        """The driver drives no more.

        Raises:
            RefusedByRobot: The page does not drive.
        """
        if self.driver != page:
            raise RefusedByRobot("this page does not drive", "there is nothing to leave")
        self._free(f"page {page} drives no more")

    def forget(self, page: int) -> None:
        """A page is gone for good: it asks for nothing more."""
        if page in self.asking:
            self.asking.remove(page)
            self.changed = True

    def beat(self, page: int, now: float) -> None:
        """A page shows that it is awake, which counts if it drives."""
        if self.driver == page:
            self._heard_at = now

    def expire(self, now: float) -> bool:
        """Take the baton from a driver that has been silent for too long. Returns whether it was.

        Args:
            now: The time, s.
        """
        if self.driver is None or now - self._heard_at <= SILENT_S:
            return False
        self._free(
            f"page {self.driver} was silent for {SILENT_S:g} s: it was closed, reloaded or hidden,"
            " or its computer sleeps"
        )
        return True

    def _hand_to(self, page: int, now: float, why: str = "") -> None:
        self.driver, self.why, self.changed = page, why, True
        self._heard_at = now
        if page in self.asking:
            self.asking.remove(page)

    def _free(self, why: str) -> None:
        self.driver, self.why, self.changed = None, why, True
