"""Computes the cells of a run on a Dask cluster.

The result of a cell does not depend on where it is computed, or how often: workers must have the
sources of this computer, and get the motor's constants from it (see Setting).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Generator
from concurrent.futures import CancelledError
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from queue import Empty, SimpleQueue
from time import monotonic, sleep
from typing import TYPE_CHECKING, Any

from host.errors import NoLink, NotDone, WrongUse, quotable
from host.runs.contract import Cell, Row, Setting
from host.util.installation import install_command
from host.util.provenance import sources, unchanged

if TYPE_CHECKING:
    from distributed import Client, Future

# How long (s) the scheduler may take to answer; how long it may have no worker at first, and after
# it has lost all; and how often to look while no result comes.
ANSWER_S, FIRST_WORKER_S, NEXT_WORKER_S, LOOK_S = 8.0, 8.0, 14.0, 1.0

_RESUME = "mend it, and run the same command again: it resumes the run"
# What a worker does. It is text, which a worker without kickctl and of any version of Python can
# read: Dask waits for ever for one that could not unpickle its task.
_TASK = """(
    lambda cluster:
        ("differs", __import__("distributed").get_worker().address, differences)
        if (differences := getattr(cluster, "compare", lambda _: "another version")(computing))
        else ("rows", "", __import__("pickle").loads(work)())
)(__import__("host.runs.cluster", fromlist=["cluster"]))"""


def require_scheduler(address: str) -> None:
    """Raise WrongUse if this is no scheduler's address, or the package distributed is missing."""
    if not re.fullmatch(r"\w+://.+:\d+", address):
        raise WrongUse(
            f"'{quotable(address)}' is no address of a Dask scheduler", "it is like tcp://HOST:8786"
        )
    try:
        import distributed  # noqa: F401
    except ImportError as error:
        raise WrongUse(
            "--scheduler needs the package distributed",
            f"install it: {install_command('cluster')}",
        ) from error


def compute_on_cluster(
    address: str,
    simulate: Callable[[Cell, Setting], list[Row]],
    cells: list[Cell],
    setting: Setting,
) -> Generator[tuple[Cell, list[Row]]]:
    """Compute the cells of a run on the workers of a Dask scheduler.

    Args:
        address: The scheduler's, such as tcp://host:8786.
        simulate: Computes a cell.
        cells: What to compute.
        setting: What the cells share.

    Yields:
        (cell, its rows), in the order in which they are complete.

    Raises:
        WrongUse: The address is none, or the package distributed is missing here.
        NoLink: There is no scheduler or no worker, or they were lost.
        NotDone: A worker would compute other numbers, or lacks a package.
    """
    require_scheduler(address)
    from distributed import Client
    from distributed.protocol.pickle import dumps
    from distributed.scheduler import KilledWorker

    try:
        client = Client(address, timeout=ANSWER_S, set_as_default=False)
    except (OSError, ValueError) as error:
        raise NoLink(
            f"no Dask scheduler answers at {address}: {error}",
            f"start one: dask scheduler, and dask worker {address}",
        ) from error
    with client:
        here = computing()
        cell_of = {}
        for cell in cells:
            names = {"work": dumps(partial(simulate, cell, setting)), "computing": here}
            cell_of[client.submit(eval, _TASK, names, pure=False)] = cell
        done: SimpleQueue[Future[Any]] = SimpleQueue()
        for future in cell_of:
            future.add_done_callback(done.put)
        patience_s = FIRST_WORKER_S
        while cell_of:
            future = _next_done(done, client, address, patience_s)
            patience_s = NEXT_WORKER_S
            try:
                outcome, worker, result = future.result(timeout=ANSWER_S)
            except TimeoutError:
                # A worker that is lost takes its results with it, and Dask computes them again,
                # which may take long. A silent scheduler never answers.
                _wait_for_worker(client, address, NEXT_WORKER_S)
                future.add_done_callback(done.put)
                continue
            except (CancelledError, KilledWorker) as error:
                raise NoLink(f"the Dask cluster at {address} was lost: {error}", _RESUME) from error
            except ImportError as error:
                raise NotDone(
                    f"a Dask worker of {address} lacks a package: {error}",
                    "install this release of kickctl there, with what its extras need, start the"
                    " worker again, and run the same command again",
                ) from error
            if outcome == "differs":
                raise NotDone(
                    f"the Dask worker at {worker} would compute other numbers than this computer:"
                    f" it has {result}",
                    "install there what this computer has, start the worker again, and run the"
                    " same command again",
                )
            yield cell_of.pop(future), result


def computing() -> dict[str, str]:
    """What decides about numbers, and its version here; empty for a package that is not here."""
    own = sources() if unchanged() else "some that have changed since it began"
    return {"the sources": own, **{name: _version(name) for name in ("numpy", "mujoco-core")}}


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


def compare(theirs: dict[str, str]) -> str:
    """What of `computing` this computer has in another version; empty if nothing."""
    return ", ".join(
        f"{name} {own} instead of {theirs[name]}"
        for name, own in computing().items()
        if own and theirs[name] and own != theirs[name]
    )


def _next_done(
    done: SimpleQueue[Future[Any]], client: Client, address: str, patience_s: float
) -> Future[Any]:
    """Wait for the next future that is complete. Raises NoLink as _wait_for_worker does."""
    while True:
        try:
            return done.get(timeout=LOOK_S)
        except Empty:
            _wait_for_worker(client, address, patience_s)


def _wait_for_worker(client: Client, address: str, patience_s: float) -> None:
    """Wait until the scheduler has a worker.

    Raises NoLink if it falls silent, or has none for longer than patience_s.
    """
    deadline_s = monotonic() + patience_s
    while not _count_workers(client, address):
        if monotonic() > deadline_s:
            raise NoLink(
                f"the Dask scheduler at {address} has no worker",
                f"start one: dask worker {address}; then run the same command again, which"
                " resumes the run",
            )
        sleep(LOOK_S)


def _count_workers(client: Client, address: str) -> int:
    """How many workers the scheduler has now. Raises NoLink if it does not answer."""
    if client.scheduler is None:
        return 0
    try:
        return len(client.sync(client.scheduler.ncores, callback_timeout=ANSWER_S))
    except OSError as error:
        raise _silent(address) from error


def _silent(address: str) -> NoLink:
    return NoLink(f"the Dask cluster at {address} was lost: its scheduler does not answer", _RESUME)
