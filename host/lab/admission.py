"""Which pages a lab lets in."""

from __future__ import annotations

from host.lab.keys import DRIVE

# How many pages there may be; some of the places are kept for those that may drive.
MAX_PAGES, KEPT_FOR_DRIVERS = 64, 4


def refusal(key: str, role: str | None, pages: int, *, local: bool) -> tuple[str, str] | None:
    """Why a page may not join.

    Args:
        key: The key that it has said.
        role: The role that this key gives; None for none.
        pages: How many pages there are.
        local: Whether it is on this computer.

    Returns:
        A message and a hint; None if it may.
    """
    if not key:
        return (
            "this address has no key",
            "scan the code again, or copy the whole address: its end, from the # on, is the key",
        )
    if role is None:
        return (
            "the key in this address does not fit: the lab may have been started again since",
            "scan the code again, ask your teacher, or use the lab's newest address",
        )
    if role == DRIVE and not local:
        return (
            "the drive key works only on the computer on which the lab runs",
            "use the address for watching",
        )
    if pages >= MAX_PAGES - (0 if role == DRIVE else KEPT_FOR_DRIVERS):
        return (
            f"all places for pages are taken: {pages} pages are open",
            "close one that nobody needs",
        )
    return None
