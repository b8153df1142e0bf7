"""Notice foreign packages that have the names of ours, before Python takes them for ours.

kickctl's parts are the packages robot, host and sim_motor beside this one. These names are common:
Robot Framework is a package `robot`, and a notebook's folder may hold a file robot.py.
"""

from __future__ import annotations

import sys
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from pathlib import Path

PARTS = ("robot", "host", "sim_motor")
OWN_FOLDER = Path(__file__).resolve().parents[1]
# Every part's __init__.py says so; where two packages were installed into one folder, it is the
# other one's if it does not.
SIGN = "Part of kickctl."


class ForeignPackage(ImportError):
    """Another package has the name of a part of kickctl, and Python finds that one first."""


def check() -> None:
    """Look where Python finds each part of kickctl.

    Raises:
        ForeignPackage: One of them is not ours.
        SystemExit: The same, for the command `kickctl`: its words are printed, without a traceback.
    """
    for name in PARTS:
        words = complaint(name)
        if words:
            if _is_the_command():
                print(f"kickctl: {words}", file=sys.stderr)
                raise SystemExit(2)
            raise ForeignPackage(words)


def complaint(name: str) -> str:
    """What is wrong with the part that Python finds, and what to do; empty if it is ours."""
    place = _place(name)
    if place is None:
        return (
            f"its part '{name}' is missing beside {OWN_FOLDER / 'kickctl'}.\n"
            "  Install kickctl again."
        )
    if place == OWN_FOLDER / name and SIGN in _text(place / "__init__.py"):
        return ""
    found = f"Python takes another '{name}' for a part of kickctl of the same name: {place}.\n"
    if _is_installed(place):
        return (
            found + "  Two packages with this name cannot be installed together. Give kickctl an"
            " environment of its own: `pipx install` or `uv tool install` for the command, a new"
            " virtual environment (python -m venv) for notebooks."
        )
    return (
        found + "  Rename it, for example to my_"
        f"{place.name}, or work in another folder; and restart Python."
    )


def _place(name: str) -> Path | None:
    """The file or the folder that `import name` leads to, or has led to; None if there is none."""
    try:
        spec = find_spec(name)
    except ValueError:  # a module that a program has built by hand
        return Path(getattr(sys.modules[name], "__file__", None) or "no file")
    return None if spec is None else _place_of(spec)


def _place_of(spec: ModuleSpec) -> Path:
    if spec.origin is not None and spec.has_location:
        file = Path(spec.origin).resolve()
        return file.parent if file.name == "__init__.py" else file
    folders = list(spec.submodule_search_locations or ())
    return Path(folders[0]).resolve() if folders else Path(str(spec.origin))


def _text(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""


def _is_installed(place: Path) -> bool:
    return any(part in ("site-packages", "dist-packages") for part in place.parts)


def _is_the_command() -> bool:
    """Whether this process is `kickctl`, `python -m kickctl` or `python -m host`."""
    module = sys.orig_argv[1:3] in (["-m", "kickctl"], ["-m", "host"])
    return module or Path(sys.argv[0] if sys.argv else "").name == "kickctl"
