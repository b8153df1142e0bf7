"""README and the pages as somebody types them: each command, line by line, in an empty folder.

A robot that has a name or an address is a simulated one in a process of its own. Pages that other
tests type are named in ELSEWHERE. `make test-long` types what takes long.
"""

import os
import re
import shlex
import signal
import sys
import threading
from contextlib import ExitStack
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from robot.program import own_address
from tests.cli.conftest import DRAW
from tests.cli.test_desk import desk_robot
from tests.lint.sources import ROOT
from tests.package.test_commands_of_pages import TYPED, lines

ELSEWHERE = {
    "docs/lesson.md": "tests/cli/test_lesson.py",
    "docs/own-motors.md": "tests/api/test_own_motors_page.py",
}
# It would copy a program to a brick. tests/package/test_deploy_verb.py does it.
NEEDS_A_BRICK = ("kickctl deploy ", "kickctl experiment reliability --brick ssh://...")
# It asks the network. tests/deploy/test_discover.py answers.
NEEDS_A_NETWORK = ("kickctl discover ",)
# Ten seconds to two minutes.
LONG = (
    "kickctl body train --scene walls --time 40 --film train.mp4",
    "kickctl experiment train-start",
    "kickctl experiment kick-map --kicks 1000000",
    "kickctl plan --to backward --search least-effort",
    "kickctl theory lyapunov --k 5:20:16",
)
# tests/cli/test_watch_terminal.py looks at what it shows.
NEEDS_A_TERMINAL = ("kickctl --brick tcp://127.0.0.1:5425 watch",)
# They go on until somebody types ^C.
LASTING = ("lab", "foxglove")
# They fail where nothing can be drawn.
PICTURES = ("plot", "film", "--film", "rods")
FAILS = {"kickctl kick --mode phase --ticks 1 --seed 6": 1}
# What a page takes for granted.
BEFORE = {
    "robot/README.md": ["export KICK_BRICK=anna"],
    "docs/logs.md": ["kickctl record 1 --out mine.mcap"],
    "docs/lab.md": ["kickctl record 1 --out logs/a.mcap"],
}
ADDRESSES = re.compile(r"tcp://[\d.]+(:\d+)?|ssh://[\w.@-]+")


def typed_lines(page):
    """The lines of a page's blocks that run kickctl, or set what it is to know."""
    for line in lines(page):
        if re.match(r"(\.venv/bin/)?kickctl |export ", line):
            yield line.removeprefix(".venv/bin/").partition("  #")[0].strip()


PAGES = [page for page in TYPED if list(typed_lines(page))]
HERE = [page for page in PAGES if page not in ELSEWHERE]


@pytest.fixture(scope="module")
def robots(tmp_path_factory):
    """A folder with NAME/token for each of two robots, and {name: address}."""
    folder = tmp_path_factory.mktemp("robots")
    with ExitStack() as stack:
        found = {}
        for name in ("anna", "bert"):
            (folder / name).mkdir()
            found[name] = stack.enter_context(desk_robot(folder / name))[0]
        yield folder, found


class Reader:
    """Standard output, before which somebody sits who reads the first line, and types ^C."""

    def __init__(self, output):
        self._output = output
        self._read = False

    def write(self, text):
        if not self._read:
            self._read = True
            threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
        return self._output.write(text)

    def __getattr__(self, name):
        return getattr(self._output, name)


@pytest.fixture
def typed(kickctl, robots, tmp_path, monkeypatch):
    """Type a line, and see what it answers."""
    folder, uris = robots
    (tmp_path / "bert.token").write_bytes((folder / "bert" / "token").read_bytes())
    (tmp_path / "bert.token").chmod(0o600)
    (tmp_path / "logs").mkdir()
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):  # or a lab opens a browser
        monkeypatch.delenv(name, raising=False)
    token = ("--token", str(folder / "anna" / "token"))
    assert kickctl("robots", "add", "anna", uris["anna"], *token)[0] == 0
    token = ("--token", "bert.token")
    assert kickctl("robots", "add", "bert", uris["bert"], *token)[0] == 0
    # They roll, as after a deploy.
    for verb in ("stop", "start"):
        assert kickctl("--brick", "all", verb)[0] == 0

    def type_line(line):
        if line.startswith("export "):
            name, _, value = line.removeprefix("export ").partition("=")
            monkeypatch.setenv(name, value)
            return
        words = shlex.split(line)[1:]
        target = words[words.index(">") + 1] if ">" in words else None
        words = words[: words.index(">")] if target else words
        if words[:2] == ["robots", "add"]:
            words = [ADDRESSES.sub(uris[words[2]], word) for word in words]
        else:
            words = [ADDRESSES.sub("anna", word) for word in words]
        with monkeypatch.context() as patch:
            if {*PICTURES} & {*words}:
                patch.setattr(Figure, "draw", DRAW)
            if lasts(words):
                words += ["--port", "0"]
                patch.setattr(sys, "stdout", Reader(sys.stdout))
            status, out, err = kickctl(*words)
        assert status == FAILS.get(line, 0), (line, out, err)
        assert "Traceback" not in out + err
        assert out, line
        if target:
            Path(target).write_text(out, encoding="utf-8")

    return type_line


def lasts(words):
    """Whether a command goes on until ^C."""
    ends = ("--export", "--layout")
    return bool({*LASTING} & {*words}) and not {*ends} & {*words}


@pytest.mark.parametrize("page", HERE)
def test_a_page(page, typed):
    for line in BEFORE.get(page, []):
        typed(line)
    for line in typed_lines(page):
        if line.startswith(NEEDS_A_BRICK + NEEDS_A_NETWORK + NEEDS_A_TERMINAL) or line in LONG:
            continue
        if "--class" in line and own_address().startswith("127."):
            continue  # in no network; it is refused, as tests/cli/test_lab.py has it
        typed(line)


@pytest.mark.long
@pytest.mark.timeout(600)
@pytest.mark.parametrize("line", LONG)
def test_a_long_command(line, typed):
    typed(line)


def test_what_is_not_typed_here_is_somewhere():
    everything = [line for page in PAGES for line in typed_lines(page)]
    for left_out in (*NEEDS_A_BRICK, *NEEDS_A_NETWORK, *NEEDS_A_TERMINAL, *LONG, *FAILS):
        assert any(line.startswith(left_out) for line in everything), left_out
    for page, test in ELSEWHERE.items():
        assert page in PAGES
        assert Path(page).name in (ROOT / test).read_text(encoding="utf-8")
