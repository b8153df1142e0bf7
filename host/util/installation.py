"""How this copy of kickctl was installed, and what a person types here to install or deploy."""

from __future__ import annotations

import shlex
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# In a checkout it is a link to the one at the top; an installed kickctl has a copy of that.
DEPLOY_SCRIPT = Path(__file__).resolve().parents[1] / "deploy.sh"


def is_checkout() -> bool:
    """Whether kickctl runs from a folder with its sources and Makefile, not from a package."""
    return (ROOT / "Makefile").is_file()


def _works_there() -> bool:
    """Whether the working folder, which may be gone by now, is the checkout's."""
    try:
        return Path.cwd() == ROOT
    except OSError:
        return False


def kickctl_command() -> str:
    """What starts this very kickctl in a shell."""
    if shutil.which("kickctl"):
        return "kickctl"
    if Path(sys.argv[0]).name == "kickctl":
        return shlex.quote(sys.argv[0])
    return f"{shlex.quote(sys.executable)} -m kickctl"


def deploy_command() -> str:
    """What brings the robot's program to a brick: deploy.sh in a checkout, else kickctl deploy."""
    if not is_checkout():
        return f"{kickctl_command()} deploy"
    return "./deploy.sh" if _works_there() else shlex.quote(str(ROOT / "deploy.sh"))


def install_command(extra: str = "") -> str:
    """What installs the libraries that are missing here.

    Args:
        extra: The extra of the package that has them; without it, what kickctl always needs.
    """
    if is_checkout():
        return "make setup" if _works_there() else f"make -C {shlex.quote(str(ROOT))} setup"
    name = f"'kickctl[{extra}]'" if extra else "kickctl"
    return f"{shlex.quote(sys.executable)} -m pip install {name}"
