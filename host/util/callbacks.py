"""Functions of a user's program that kickctl calls: what they raise ends nothing but themselves."""

from __future__ import annotations

import threading
from collections.abc import Callable


def failure_of(call: Callable[[], object]) -> BaseException | None:
    """Call a function of the user's program.

    It may run in the thread that keeps the link, and the robot, alive. So nothing that it raises
    passes on from here, `sys.exit()` neither; but ^C does in the main thread.

    Args:
        call: The function.

    Returns:
        What it has raised; None if it has raised nothing.
    """
    try:
        call()
    except KeyboardInterrupt as error:
        if threading.current_thread() is threading.main_thread():
            raise
        return error
    except BaseException as error:  # noqa: BLE001
        return error
    return None
