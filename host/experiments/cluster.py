"""Spreads an experiment's simulations over a Dask cluster. A cell's result does not depend on where it is done, or how often."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from host.errors import NoLink, WrongUse
from host.experiments.experiment import Cell, Row, Setting

CONNECT_S = 10.0


def spread(
    address: str, simulate: Callable[[Cell, Setting], list[Row]], cells: list[Cell], setting: Setting
) -> Iterator[tuple[Cell, list[Row]]]:
    """(cell, rows) as they are done, on the workers of the Dask scheduler at `address`. Raises WrongUse and NoLink."""
    try:
        from distributed import Client, as_completed
    except ImportError as error:
        raise WrongUse("--scheduler needs the package distributed", "install it: pip install 'kickctl[cluster]'") from error
    try:
        client = Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        raise NoLink(f"no Dask scheduler answers at {address}: {error}", "start one: dask scheduler, and dask worker ADDRESS") from error
    with client:
        futures = {client.submit(simulate, cell, setting, pure=False): cell for cell in cells}
        for future in as_completed(futures):
            yield futures[future], future.result()
