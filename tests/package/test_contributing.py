"""CONTRIBUTING.md: its examples do what it says, in a copy of the sources."""

import os
import re
import shutil
import subprocess
import sys

import pytest

from tests.package.conftest import ROOT

PAGE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
EXPERIMENT, KICK, BODY = (
    next(part for part in PAGE.split("\n## ") if part.startswith(title))
    for title in ("An experiment", "A kick", "A body")
)


def blocks(section, language):
    return re.findall(rf"```{language}\n(.*?)```", section, re.DOTALL)


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """A copy of the sources with all three examples in it."""
    folder = tmp_path_factory.mktemp("copy")
    for name in ("robot", "host", "sim_motor", "kickctl"):
        shutil.copytree(ROOT / name, folder / name)
    for path, code in re.findall(
        r"`(host/\S+\.py)`:\n\n```python\n(.*?)```", EXPERIMENT, re.DOTALL
    ):
        (folder / path).write_text(code, encoding="utf-8")
    for change in blocks(EXPERIMENT, "diff") + blocks(KICK, "diff"):
        apply = ["git", "apply", "--recount", "-C1", "-"]
        subprocess.run(apply, input=change, cwd=folder, text=True, check=True)
    with (folder / "sim_motor/bodies/presets.toml").open("a", encoding="utf-8") as presets:
        presets.write("\n" + "".join(blocks(BODY, "toml")))
    return folder


@pytest.mark.parametrize(
    ("section", "status", "words"),
    [
        (EXPERIMENT, 0, r"mean_rad (0\.[5-9]|[1-9]\.)\d+\n"),
        (KICK, 1, r"The kick did NOT reverse the robot: a half kick of 1 tick"),
        (BODY, 0, r"1 s: \d\.\d+ m/s"),
    ],
)
def test_an_example_runs_as_it_is_written(copy, tmp_path, section, status, words):
    (line,) = blocks(section, "sh")
    done = subprocess.run(
        ["sh", "-c", line.replace("kickctl", f"{sys.executable} -m host")],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(copy)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr.count("Traceback")) == (status, 0), done.stderr
    assert re.search(words, done.stdout), done.stdout


@pytest.mark.parametrize("section", [EXPERIMENT, KICK, BODY])
def test_an_example_is_short(section):
    code = "".join(blocks(section, "(?:python|toml)")).splitlines()
    changes = [
        line
        for change in blocks(section, "diff")
        for line in change.splitlines()
        if re.match(r"\+(?!\+\+)", line)
    ]
    assert len([line for line in code if line] + changes) < 40
