"""A copy of the checkout, its packages, and an environment with kickctl from the wheel."""

import os
import shutil
import subprocess
import sys
import sysconfig
import venv
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
# What may stand at the top of a checkout without being part of it.
FOREIGN = (".*", "build", "logs", "results", "*.egg-info")


def succeed(*command, cwd, **environment):
    """Run a command that has to succeed. Returns its standard output."""
    done = subprocess.run(
        command,
        cwd=cwd,
        env={**os.environ, **environment},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def build(what, source, target):
    """Build 'sdist' or 'wheel' of a folder with sources: the file."""
    script = (
        "import setuptools.build_meta as b, sys; getattr(b, 'build_' + sys.argv[1])(sys.argv[2])"
    )
    succeed(sys.executable, "-c", script, what, target, cwd=source)
    (file,) = target.iterdir()
    return file


@pytest.fixture(scope="session")
def source(tmp_path_factory):
    """A copy of the checkout."""
    folder = tmp_path_factory.mktemp("source") / "kickctl"
    foreign = shutil.ignore_patterns(*FOREIGN)
    compiled = shutil.ignore_patterns("__pycache__")

    def ignored(path, names):
        return (foreign if Path(path) == ROOT else compiled)(path, names)

    shutil.copytree(ROOT, folder, symlinks=True, ignore=ignored)
    shutil.copytree(ROOT / ".ci", folder / ".ci")
    return folder


@pytest.fixture(scope="session")
def wheel(source, tmp_path_factory):
    """The wheel that pip builds from the checkout, without a network."""
    target = tmp_path_factory.mktemp("wheel")
    options = ("--quiet", "--no-deps", "--no-build-isolation", "--no-index", "--wheel-dir")
    succeed(sys.executable, "-m", "pip", "wheel", *options, target, source, cwd=target)
    (wheel,) = target.iterdir()
    return wheel


@pytest.fixture(scope="session")
def sdist(source, tmp_path_factory):
    """The source distribution."""
    return build("sdist", source, tmp_path_factory.mktemp("sdist"))


@pytest.fixture(scope="session")
def wheel_of_sdist(sdist, tmp_path_factory):
    """The wheel that is built from the unpacked source distribution."""
    folder = tmp_path_factory.mktemp("unpacked")
    succeed("tar", "-xzf", sdist, cwd=folder)
    (unpacked,) = folder.iterdir()
    return build("wheel", unpacked, tmp_path_factory.mktemp("wheel-of-sdist"))


@pytest.fixture(scope="session")
def installed(wheel, tmp_path_factory):
    """The bin folder of a new environment: kickctl from the wheel, the rest from this one."""
    folder = tmp_path_factory.mktemp("installed") / "environment"
    venv.create(folder, symlinks=True, with_pip=False)
    python = folder / "bin" / "python"
    pip = (sys.executable, "-m", "pip", "--python", python, "install")
    succeed(*pip, "--quiet", "--no-deps", "--no-index", wheel, cwd=folder)
    paths = {"base": str(folder), "platbase": str(folder)}
    packages = Path(sysconfig.get_path("purelib", vars=paths))
    # A line of a .pth file leads to modules, but no .pth file there counts: of these packages
    # kickctl itself, installed to be edited, would be found by its own .pth only.
    (packages / "others.pth").write_text(sysconfig.get_path("purelib") + "\n", encoding="utf-8")
    return folder / "bin"


def files_of(wheel):
    """The content of a wheel's files, by name."""
    with zipfile.ZipFile(wheel) as archive:
        return {name: archive.read(name) for name in archive.namelist()}
