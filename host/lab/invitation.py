"""How others come to the page: its address for watching, also as a QR code."""

from __future__ import annotations

from functools import cache
from ipaddress import ip_address
from typing import Any
from urllib.parse import urlsplit


@cache
def invitation(url: str) -> dict[str, Any]:
    """The result of an `invite` request.

    Args:
        url: The page's address for who watches.

    Returns:
        `url`; `svg`: the same as a QR code, an image whose modules are one unit wide; `local`:
        whether only this computer can open it.
    """
    # Imported where it is used: most labs invite nobody.
    import segno

    code = segno.make(url, error="m", micro=False)
    svg = code.svg_inline(border=4, omitsize=True, svgclass=None, lineclass=None, light="#fff")
    host = urlsplit(url).hostname or ""
    return {"url": url, "svg": svg, "local": ip_address(host).is_loopback}
