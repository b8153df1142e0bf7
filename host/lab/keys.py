"""The two keys of a lab: with one a page drives robots, with the other it watches."""

from __future__ import annotations

import secrets
from dataclasses import dataclass, field

DRIVE, VIEW = "drive", "view"
_BYTES = 16


def _new() -> str:
    return secrets.token_urlsafe(_BYTES)


@dataclass(frozen=True)
class Keys:
    """New random keys, which hold as long as the server runs.

    Attributes:
        drive: With it a page drives.
        view: With it a page watches.
        lab: No key, but the name of this run of the lab, which all pages get.
    """

    drive: str = field(default_factory=_new, repr=False)
    view: str = field(default_factory=_new, repr=False)
    lab: str = field(default_factory=_new, repr=False)

    def role(self, key: str) -> str | None:
        """The role that a key gives; None if it is no key of this lab.

        It takes as long for a wrong key as for a right one.
        """
        given = key.encode(errors="surrogatepass")
        drives = secrets.compare_digest(given, self.drive.encode())
        views = secrets.compare_digest(given, self.view.encode())
        return DRIVE if drives else VIEW if views else None
