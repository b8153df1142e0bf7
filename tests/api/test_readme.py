"""README's notebook example, run as it is written."""

import re
import subprocess
import sys

from tests.lint.sources import ROOT


def example():
    """The first block of Python in README.md."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    return re.search(r"```python\n(.*?)```", readme, re.DOTALL)[1]


def test_the_example_shows_a_kick_and_its_log(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(compile(example(), "README.md", "exec"), names)  # noqa: S102 - this is what it is for
    assert "kick of 4 ticks" in capsys.readouterr().out
    ((begin, kick),) = names["log"].kicks()
    assert (kick["mode"], kick["ticks"]) == ("phase", 4)
    assert 0 < begin < len(names["log"]) - 4
    assert names["outcome"].applied_tick == names["log"].records[begin].tick


def test_what_the_comments_name_exists(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(compile(example(), "README.md", "exec"), names)  # noqa: S102
    calls = re.findall(r"log\.\w+\([^)]*\)", example())
    assert len(calls) >= 4
    for call in calls:
        eval(call, names)  # noqa: S307
    assert {path.name for path in tmp_path.iterdir()} >= {"a.mcap", "a.csv", "a.npz"}


def test_it_runs_as_a_program_of_its_own(tmp_path):
    program = tmp_path / "notebook.py"
    program.write_text(example())
    done = subprocess.run(
        [sys.executable, program.name], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout.startswith("The kick ")
