"""Where the project's sources are."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("robot", "sim_motor", "host")


def modules(*folders: str) -> list[str]:
    """The Python files below the folders, relative to the root, in order."""
    return [str(path.relative_to(ROOT)) for folder in folders for path in sorted((ROOT / folder).rglob("*.py"))]
