"""Libraries that an extra of the package brings, such as MuJoCo."""

from __future__ import annotations

import importlib

from host.errors import NotDone, WrongUse
from host.util.installation import install_command
from host.util.interrupts import uninterrupted


def need(module: str, extra: str) -> None:
    """Raise WrongUse if a library of an extra is not installed."""
    try:
        with uninterrupted():  # a ^C would look as if the library could not be loaded, or be lost
            importlib.import_module(module)
    except ModuleNotFoundError as error:
        raise WrongUse(
            f"this needs {module}, which is not installed",
            f"install it: {install_command(extra)}",
        ) from error
    except (
        RuntimeError,
        AttributeError,
        ImportError,
        OSError,
    ) as error:  # as mujoco does with a MUJOCO_GL that it cannot use
        raise NotDone(
            f"{module} cannot be loaded: {error}",
            "is MUJOCO_GL set to something? unset it, or set it to egl or osmesa"
            if module in ("mujoco", "glfw")
            else f"install it again: {install_command(extra)}",
        ) from error
