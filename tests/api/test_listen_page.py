"""docs/listen.md: its blocks run as they are written, on an embedded robot and on a real link."""

import re

import pytest

from robot.wire import TOKEN_BYTES
from tests.link.machines import TcpRobot
from tests.lint.sources import ROOT

PAGE = (ROOT / "docs" / "listen.md").read_text(encoding="utf-8")
# The blocks of a section are the cells of one program.
PROGRAMS = {
    section.partition("\n")[0]: re.findall(r"```python\n(.*?)```", section, re.DOTALL)
    for section in PAGE.split("\n## ")[1:]
}
PROGRAMS = {title: blocks for title, blocks in PROGRAMS.items() if blocks}


@pytest.fixture(params=["embedded", "real link"])
def place(request, tmp_path, monkeypatch):
    """Where `connect()` leads."""
    if request.param == "embedded":
        yield
        return
    machine = TcpRobot(link_loss_s=5.0, tick_s=0.03)
    token = tmp_path / "token"
    token.write_text(bytes(range(TOKEN_BYTES)).hex(), encoding="ascii")
    token.chmod(0o600)
    monkeypatch.setenv("KICK_BRICK", f"tcp://127.0.0.1:{machine.port}")
    yield
    machine.close()


@pytest.fixture
def run(place, capsys):
    """Run a section's blocks in order, in one program: (what they print, their names)."""

    def run(title):
        names = {}
        for block in PROGRAMS[title]:
            exec(compile(block, "listen.md", "exec"), names)  # noqa: S102 - what it is for
        return capsys.readouterr().out, names

    return run


def test_a_callback(run, caplog):
    out, names = run("A callback")
    assert re.fullmatch(r"\d+ records, 0 dropped, 1 failures\n", out)
    assert len(names["turns"]) > 10
    assert str(names["listener"].error) == "this ends nothing"
    assert "on_record failed" in caplog.text


def test_a_loop(run):
    out, names = run("A loop")
    assert out.endswith("0 records dropped\n")
    assert names["record"].tick > 0


def test_a_thread(run):
    out, names = run("A thread")
    assert out.startswith("stopped '")
    assert not names["watcher"].is_alive()


def test_asyncio(run):
    out, _ = run("asyncio")
    ticks, tick = re.fullmatch(r"(\d+) ticks\nstopped in tick (\d+)\n", out).groups()
    assert 10 < int(ticks) <= 69
    assert int(tick) >= int(ticks)


def test_a_notebook(run):
    out, names = run("A notebook")
    assert re.match(r"tick \d+, 0 records dropped\nthe left wheel turns by -?\d", out)
    assert len(names["newest"]) > 10
    assert names["listener"].failures == 0


def test_every_block_is_run_here():
    assert len(PROGRAMS) == 5
    assert sum(map(len, PROGRAMS.values())) == PAGE.count("```python")
