"""Where the project's sources are."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("robot", "sim_motor", "host", "kickctl")


def modules(*folders: str) -> list[str]:
    """The Python files below the folders, relative to the root, in order."""
    return [
        str(path.relative_to(ROOT))
        for folder in folders
        for path in sorted((ROOT / folder).rglob("*.py"))
    ]


def scripts() -> list[str]:
    """The Makefile and the shell scripts, relative to the root, in order."""
    shell = (path for folder in ("robot", "host") for path in (ROOT / folder).rglob("*.sh"))
    return ["Makefile", ".ci/run", *sorted(str(path.relative_to(ROOT)) for path in shell)]


def robot_tests() -> list[str]:
    """What `make test-py35` runs.

    The unit tests named after the robot's modules, and what else needs nothing but the robot.
    """
    unit = (
        path
        for module in sorted((ROOT / "robot").glob("*.py"))
        for path in sorted((ROOT / "tests/unit/robot").glob("test_*.py"))
        if path.stem == f"test_{module.stem}" or path.stem.startswith(f"test_{module.stem}_")
    )
    return [
        *(str(path.relative_to(ROOT)) for path in unit),
        "tests/link/test_wire.py",
        "tests/sysfs/test_one_core.py",
        "tests/sysfs/test_panels.py",
        "tests/sysfs/test_warm.py",
    ]


if __name__ == "__main__":
    print(*robot_tests())
