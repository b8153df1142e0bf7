"""Packages and files of other people that have the names of kickctl's parts are explained."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.lint.sources import ROOMS, ROOT

REMEDY_FILE = "Rename it"
REMEDY_PACKAGE = "environment of its own"


def run(*arguments, cwd, path=(), status=None):
    """(standard output, standard error) of Python in a folder, with a PYTHONPATH."""
    environment = dict(os.environ, PYTHONPATH=os.pathsep.join(map(str, path)))
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=cwd,
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    if status is not None:
        assert done.returncode == status, done.stderr
    return done.stdout, done.stderr


def robot_framework(folder):
    """A package like Robot Framework's, which is named robot too."""
    package = folder / "robot"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text('"""Robot Framework."""\n__version__ = "7.1"\n')
    (package / "errors.py").write_text("class RobotError(Exception):\n    pass\n")
    return folder


@pytest.fixture
def entry(tmp_path):
    """The script that pip makes for the command `kickctl`."""
    script = tmp_path / "bin" / "kickctl"
    script.parent.mkdir()
    script.write_text("import sys\nfrom kickctl.__main__ import main\nsys.exit(main())\n")
    return script


@pytest.mark.parametrize("name", ["robot", "host", "sim_motor"])
def test_a_file_beside_the_notebook(tmp_path, name):
    """A notebook's folder comes first on sys.path, as that of `python -c` does."""
    (tmp_path / f"{name}.py").write_text("raise RuntimeError('imported')\n")
    for code in ("import kickctl", "from kickctl import connect"):
        _, err = run("-c", code, cwd=tmp_path, path=[ROOT], status=1)
        assert str(tmp_path / f"{name}.py") in err
        assert REMEDY_FILE in err
        assert "RuntimeError" not in err


def test_a_foreign_package_first_on_the_path(tmp_path):
    other = robot_framework(tmp_path / "lib" / "site-packages")
    _, err = run("-c", "import kickctl", cwd=tmp_path, path=[other, ROOT], status=1)
    assert REMEDY_PACKAGE in err
    assert "pipx" in err
    assert "uv tool install" in err
    assert str(other / "robot") in err


def test_a_foreign_package_that_was_imported_before(tmp_path):
    other = robot_framework(tmp_path)
    code = f"import sys; sys.path.insert(0, {str(other)!r}); import robot; sys.path.pop(0)"
    _, err = run("-c", f"{code}; import kickctl", cwd="/", path=[ROOT], status=1)
    assert "Python takes another 'robot'" in err


def test_a_module_made_by_hand_is_no_part(tmp_path):
    code = "import sys, types; sys.modules['host'] = types.ModuleType('host'); import kickctl"
    _, err = run("-c", code, cwd=tmp_path, path=[ROOT], status=1)
    assert "Python takes another 'host'" in err


def test_two_packages_installed_into_one_folder(tmp_path):
    """pip lets Robot Framework overwrite robot/__init__.py of kickctl, in the same place."""
    site = tmp_path / "site-packages"
    for room in ROOMS:
        shutil.copytree(ROOT / room, site / room, ignore=shutil.ignore_patterns("__pycache__"))
    run("-c", "import kickctl", cwd=tmp_path, path=[site], status=0)
    (site / "robot" / "__init__.py").write_text('"""Robot Framework."""\n')
    _, err = run("-c", "import kickctl", cwd=tmp_path, path=[site], status=1)
    assert REMEDY_PACKAGE in err


def test_a_part_that_is_missing(tmp_path):
    shutil.copytree(ROOT / "kickctl", tmp_path / "kickctl")
    _, err = run("-S", "-c", "import kickctl", cwd=tmp_path, status=1)  # -S: no site-packages
    assert "'robot' is missing" in err


@pytest.mark.parametrize("arguments", [("--version",), ("status", "--json"), ()])
def test_the_command_says_it_without_a_traceback(tmp_path, entry, arguments):
    other = robot_framework(tmp_path / "site-packages")
    for command in ((str(entry),), ("-m", "kickctl"), ("-m", "host")):
        out, err = run(*command, *arguments, cwd=tmp_path, path=[other, ROOT], status=2)
        assert err.startswith("kickctl: Python takes another 'robot'")
        assert "Traceback" not in err
        assert out == ""


def test_a_foreign_file_beside_python_m_host_is_said_without_a_traceback(tmp_path):
    (tmp_path / "robot.py").write_text("raise RuntimeError('imported')\n")
    out, err = run("-m", "host", "status", cwd=tmp_path, path=[ROOT], status=2)
    assert err.startswith("kickctl: Python takes another 'robot'")
    assert "Traceback" not in err
    assert out == ""


def test_the_command_works_where_nothing_is_foreign(tmp_path, entry):
    for command in ((str(entry),), ("-m", "kickctl"), ("-m", "host")):
        out, _ = run(*command, "--version", cwd=tmp_path, path=[ROOT], status=0)
        assert out.startswith("kickctl ")


def test_the_own_parts_are_found_in_whatever_folder_one_works():
    for folder in (ROOT, Path("/")):
        run("-c", "import kickctl; kickctl.Log", cwd=folder, path=[ROOT], status=0)
