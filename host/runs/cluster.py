"""Computes the cells of a run on a Dask cluster.

The result of a cell does not depend on where it is computed, or how often.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Generator
from concurrent.futures import CancelledError

from host.errors import NoLink, WrongUse
from host.runs.contract import Cell, Row, Setting
from host.util.installation import install_command

CONNECT_S = 10.0


def compute_on_cluster(
    address: str,
    simulate: Callable[[Cell, Setting], list[Row]],
    cells: list[Cell],
    setting: Setting,
) -> Generator[tuple[Cell, list[Row]]]:
    """Yields (cell, rows) as workers of the Dask scheduler at `address` complete them.

    Raises WrongUse and NoLink.
    """
    try:
        from distributed import Client, as_completed
        from distributed.scheduler import KilledWorker
    except ImportError as error:
        raise WrongUse(
            "--scheduler needs the package distributed",
            f"install it: {install_command('cluster')}",
        ) from error
    if not re.fullmatch(r"\w+://.+:\d+", address):
        raise WrongUse(
            f"'{address}' is no address of a Dask scheduler", "it is like tcp://HOST:8786"
        )
    try:
        client = Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        raise NoLink(
            f"no Dask scheduler answers at {address}: {error}",
            "start one: dask scheduler, and dask worker ADDRESS",
        ) from error
    with client:
        futures = {client.submit(simulate, cell, setting, pure=False): cell for cell in cells}
        for future in as_completed(futures, loop=client.loop):
            try:
                rows = future.result()
            except (CancelledError, KilledWorker) as error:
                raise NoLink(
                    f"the Dask cluster at {address} was lost: {error}",
                    "mend it, and run the same command again: it resumes the run",
                ) from error
            yield futures[future], rows
