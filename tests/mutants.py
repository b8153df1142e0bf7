"""`make mutants`: do the tests of robot/safety.py take every branch and notice each mutation?

Runs in a copy, with an interpreter that has mutmut and what the tests need. Returns 1 if a branch
is missed or a change survives.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SUBJECT = "robot/safety.py"
TESTS = "tests/unit/robot/test_safety.py"
CONFIG = f"""
[tool.mutmut]
source_paths = ["robot"]
only_mutate = ["{SUBJECT}"]
pytest_add_cli_args_test_selection = ["{TESTS}"]
also_copy = ["pyproject.toml"]
"""


def copy_to(folder):
    """What the tests of the subject need, in a folder of its own."""
    for name in ("robot", "pyproject.toml", "tests/conftest.py", TESTS):
        source, target = ROOT / name, folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        if source.is_dir():
            shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, target)
    with (folder / "pyproject.toml").open("a", encoding="utf-8") as file:
        file.write(CONFIG)


def run(folder, *arguments):
    """(exit status, output) of a module of this interpreter, run in the copy.

    The same examples are tried for every change.
    """
    environment = os.environ | {"CI": "1"}
    command = [sys.executable, "-m", *arguments]
    done = subprocess.run(
        command,
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    return done.returncode, done.stdout


def covered(folder):
    """Print which branches the tests take. Returns whether they take all."""
    status, output = run(
        folder,
        "coverage",
        "run",
        "--branch",
        f"--include={SUBJECT}",
        "-m",
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        TESTS,
    )
    if status == 0:
        status, output = run(folder, "coverage", "report", "--show-missing", "--fail-under=100")
    print(output, flush=True)
    return status == 0


def killed(folder):
    """Print which changes the tests did not notice. Returns whether there are none."""
    status, output = run(folder, "mutmut", "run")
    if status != 0:
        print(output)
        return False
    verdicts = [
        line.split(": ")
        for line in run(folder, "mutmut", "results", "--all", "true")[1].splitlines()
        if ": " in line
    ]
    survivors = [name.strip() for name, verdict in verdicts if verdict != "killed"]
    for name in survivors:
        print(run(folder, "mutmut", "show", name)[1])
    print(f"{len(verdicts)} changes to {SUBJECT}, {len(verdicts) - len(survivors)} noticed")
    return bool(verdicts) and not survivors


def main():
    """Returns the exit status."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        copy_to(folder)
        return 0 if all([covered(folder), killed(folder)]) else 1


if __name__ == "__main__":
    sys.exit(main())
