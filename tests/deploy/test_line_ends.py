"""A clone of the project can be deployed from, whatever git's own settings are."""

import shutil
import subprocess

import pytest

from tests.deploy.brick import ROOT

FILES = (
    "deploy.sh",
    "host/deploy/ssh.sh",
    "robot/service/brick.sh",
    "robot/service/change.sh",
    "robot/service/kickctl.service",
    "robot/loop.py",
)


@pytest.mark.parametrize("setting", ["core.autocrlf=true", "core.eol=crlf"])
def test_a_clone_has_the_line_ends_of_the_brick(tmp_path, setting):
    def git(*arguments):
        command = ["git", "-c", setting, "-c", "user.name=x", "-c", "user.email=x@x.invalid"]
        subprocess.run([*command, *arguments], cwd=tmp_path, check=True, capture_output=True)

    git("init", "--quiet", "origin")
    for name in (".gitattributes", *FILES):
        (tmp_path / "origin" / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / "origin" / name)
    git("-C", "origin", "add", "--all")
    git("-C", "origin", "commit", "--quiet", "--message", "x")
    git("clone", "--quiet", "--config", setting, "origin", "clone")
    for name in FILES:
        assert b"\r" not in (tmp_path / "clone" / name).read_bytes()
    done = subprocess.run(
        [tmp_path / "clone" / "deploy.sh", "--help"], capture_output=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, b"")
