"""What waits for a page, as it is sent: JSON texts, and records in binary messages."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping

from host.lab.page_end import Page
from host.lab.ring import MOST_RECORDS, Ring


def outgoing(page: Page, rings: Mapping[str, Ring]) -> Iterator[str | bytes]:
    """What a page has to get now. It counts as sent as soon as the next one is asked for.

    Args:
        page: The page.
        rings: The records of all robots, then of all twins, by name; in the welcome's order.

    Yields:
        Messages as MESSAGES.md has them: texts, and to a page that stays, records.
    """
    while page.waiting:
        yield json.dumps(page.waiting.popleft(), allow_nan=False)
    if page.closed:
        return
    for index, name in enumerate(page.places):
        ring = rings[name]
        while page.places[name] < ring.end:
            portion = ring.read(page.places[name], MOST_RECORDS)
            page.places[name] = portion.place
            if portion.missed:
                page.send({"type": "lost", "robot": name, "records": portion.missed})
            yield portion.message(index)
