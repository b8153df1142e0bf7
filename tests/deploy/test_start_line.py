"""How brick.sh starts Python: a start takes a brick seconds, and each option some of them."""

import os
import subprocess

import pytest

from tests.deploy.brick import ROOT, write


@pytest.mark.parametrize(
    ("package", "arguments", "alone"),
    [
        ("ev3dev2", "--left outA", True),
        ("ev3dev2", "--serial /dev/ttyUSB0", False),
        ("ev3dev2", "--idle --motors=toy:motors", False),
        ("other", "", False),
    ],
)
def test_python_looks_for_packages_unless_the_motors_are_the_only_one(
    tmp_path, package, arguments, alone
):
    kept = tmp_path / "kickctl"
    (kept / "current").mkdir(parents=True)
    (tmp_path / "packages" / package).mkdir(parents=True)
    write(kept / "arguments", arguments)
    write(tmp_path / "bin" / "python3", "#!/bin/sh\nprintf '%s\\n' \"$@\"\n", 0o755)
    subprocess.run(
        ["sh", ROOT / "robot" / "service" / "brick.sh", "run", "--idle"],
        env={
            "HOME": str(tmp_path),
            "KICK_RUN": str(tmp_path / "run"),
            "KICK_PACKAGES": str(tmp_path / "packages"),
            "PATH": f"{tmp_path / 'bin'}:{os.environ['PATH']}",
        },
        check=True,
    )
    started, *words = (kept / "robot.log").read_text(encoding="utf-8").splitlines()
    assert started.startswith("starting ")
    assert ("-S" in words) == alone
    assert f"sys.path.append('{tmp_path / 'packages'}')" in " ".join(words)
    assert words[-1 - len(arguments.split()) : -1] == arguments.split()
    assert words[-1] == "--idle"
