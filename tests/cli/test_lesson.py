"""docs/lesson.md: its steps on the simulated robot run as they are written, and show what it says.

`pytest --durations=0` prints how long each step takes.
"""

import csv
import re
import shlex
from pathlib import Path

import numpy as np
import pytest

from host.kicking.robot_claims import STALL_TORQUE
from host.logs.log import Log
from robot.kicks import WHEELS
from tests.lint.sources import ROOT

PAGE = (ROOT / "docs" / "lesson.md").read_text(encoding="utf-8")
SECTIONS = {
    section.partition("\n")[0]: section.partition("\n")[2] for section in PAGE.split("\n## ")[1:]
}
# On a robot in a process of its own, see test_lesson_desk.py.
DESK = ("4. A rest that stays", "On a real robot")
TURN = 2 * np.pi


@pytest.fixture
def figures():
    """They are as users see them."""


def commands(title):
    """The lines of a section's blocks of commands; one that ends with a backslash goes on."""
    blocks = re.findall(r"```sh\n(.*?)```", SECTIONS[title], re.DOTALL)
    return [line for block in blocks for line in block.replace("\\\n", "").splitlines()]


def shown(title):
    """The beginnings of lines that a section shows as answers."""
    blocks = re.findall(r"```text\n(.*?)```", SECTIONS[title], re.DOTALL)
    return [line.removesuffix(" ...") for block in blocks for line in block.splitlines()]


@pytest.fixture
def step(kickctl):
    """Run the commands of a step: (their exit statuses, what they print)."""

    def run(title):
        statuses, output = [], ""
        for line in commands(title):
            words = shlex.split(line, comments=True)
            assert words[0] == "kickctl", line
            status, out, err = kickctl(*words[1:])
            statuses.append(status)
            output += out
            assert status in (0, 1), err
        assert [line for line in shown(title) if line not in output] == []
        figures = re.findall(r"^figure (\S+\.png)$", output, re.MULTILINE)
        assert all((kickctl.folder / path).stat().st_size for path in figures)
        assert len(figures) == len([line for line in commands(title) if " record " not in line])
        return statuses, output

    return run


def turns(log, side):
    """How many turns a wheel makes in the log's last second."""
    angles, t = log.column(side + "_phi_rad"), log.column("t_s")
    begin = np.searchsorted(t, t[-1] - 1.0)
    return (angles[-1] - angles[begin]) / TURN / (t[-1] - t[begin])


def test_1_rest(step):
    assert step("1. Rest")[0] == [0, 0]
    log = Log.load("rest.mcap")
    for side in WHEELS:
        assert len(set(log.column(side + "_phi_rad")[-66:])) == 1
        assert 0.0 < abs(log.column(side + "_torque")[-1]) < STALL_TORQUE
    assert log.column("left_duty_pct")[-1] == -7
    assert log.column("left_torque")[-1] == pytest.approx(-0.08, abs=0.005)


def test_2_a_limit_cycle(step):
    assert step("2. A limit cycle")[0] == [0] * 4
    logs = [Log.load(f"roll-{number}.mcap") for number in (1, 2)]
    speeds = np.array([[turns(log, side) for side in WHEELS] for log in logs])
    assert np.abs(speeds) == pytest.approx(2.0, abs=0.05)
    assert np.sign(speeds[0]).tolist() != np.sign(speeds[1]).tolist()
    heights = [log.column(side + "_x1")[-66:].max() for log in logs for side in WHEELS]
    assert heights == pytest.approx([heights[0]] * 4, abs=0.02)


def test_3_where_rolling_begins(step):
    statuses, output = step("3. Where rolling begins")
    assert statuses == [0]
    assert "k_c = 0.47" in output
    assert "R6 undecided" in output


def test_5_symmetry(step):
    statuses, output = step("5. Symmetry")
    assert statuses == [0]
    counts = re.findall(r"wheel: (\d+) forward, (\d+) backward", output)
    assert [forward for forward, _ in counts] == ["38", "42"]
    assert "in 17 % of all tries" in output
    assert "in 67 % of all tries" in output
    assert output.endswith("starts.png\n")


def test_6_a_kick(step):
    statuses, output = step("6. A kick")
    assert statuses == [0, 1, 0]
    (table,) = re.findall(r"^table (\S+)$", output, re.MULTILINE)
    rows = list(csv.DictReader(Path(table).read_text(encoding="utf-8").splitlines()))
    for length in range(4, 8):
        assert re.search(rf"^ +{length}( +6 of 6){{3}}$", output, re.MULTILINE)
        assert {row["reversed"] for row in rows if row["ticks"] == str(length)} == {"True"}
    for length in (1, 2, 9, 10):
        kicks = [row for row in rows if row["ticks"] == str(length) and row["mode"] != "membrane"]
        assert "False" in {row["reversed"] for row in kicks}


def test_7_a_wall(step):
    assert step("7. A wall")[0] == [0, 0]
    log = Log.load("wall.mcap")
    for side in WHEELS:
        torque = log.column(side + "_torque")[66:]
        ways = np.sign(torque[np.abs(torque) > 0.5])
        assert np.count_nonzero(np.diff(ways)) == 4


def test_8_chaos(step):
    assert step("8. Chaos")[0] == [0] * 4
    one, other = (Log.load(f"chaos-{number}.mcap") for number in (1, 2))
    ticks = min(len(one), len(other))
    for side, part_s in (("right", 4), ("left", 7)):
        apart = np.abs(
            one.column(side + "_phi_rad")[:ticks] - other.column(side + "_phi_rad")[:ticks]
        )
        t = one.column("t_s") - one.column("t_s")[0]
        assert apart[t[:ticks] < 2.0].max() < 0.2
        assert t[np.argmax(apart > 1.0)] == pytest.approx(part_s, abs=0.5)
        assert apart.max() > TURN


def test_the_answer_that_nothing_parts_at_k_8(kickctl):
    paths = []
    for k in ("8", "8.01"):
        path = f"k-{k}.mcap"
        assert kickctl("record", "5", "--set", f"k={k}", "--seed", "1", "--out", path)[0] == 0
        paths.append(path)
    one, other = map(Log.load, paths)
    for side in WHEELS:
        assert one.column(side + "_phi_rad") == pytest.approx(
            other.column(side + "_phi_rad"), abs=0.2
        )


def test_every_block_is_run_here_or_on_the_desk():
    here = [title for title in SECTIONS if commands(title) and title not in DESK]
    assert [title[0] for title in here] == ["1", "2", "3", "5", "6", "7", "8"]
    assert all(commands(title) for title in DESK)
    assert sum(bool(commands(title)) for title in SECTIONS) == len(here) + len(DESK)


def test_each_step_has_a_question_and_an_answer():
    steps = [title for title in SECTIONS if title[0].isdigit()]
    assert all("**Question.**" in SECTIONS[title] for title in steps)
    answers = re.findall(r"^(\d)\. ", SECTIONS["Answers for the teacher"], re.MULTILINE)
    assert answers == [title[0] for title in steps]
