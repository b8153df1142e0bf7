"""Three robots with names, each a process of its own with its own token, and who may do what."""

import json
import re
import subprocess
import sys
import time
from contextlib import ExitStack

import pytest

from host.cli import main
from host.client.robot import connect
from host.errors import RefusedByRobot
from tests.cli.test_desk import desk_robot
from tests.laptop import Laptop

NAMES = ("anna", "bert", "carl")


@pytest.fixture(scope="module")
def fleet(tmp_path_factory):
    """Three running robots: {name: (address, the file of its token)}.

    They bear with drivers that a busy machine keeps silent.
    """
    with ExitStack() as stack:
        found = {}
        for name in NAMES:
            folder = tmp_path_factory.mktemp(name)
            address, _ = stack.enter_context(desk_robot(folder))
            found[name] = address, folder / "token"
        yield found


@pytest.fixture
def robots(fleet):
    """The same robots as they were when they began: {name: address}."""
    for address, token in fleet.values():
        with connect(address, token=token) as robot:
            # Who held it in the test before may have been killed just now.
            robot.wait(20.0, until=lambda robot=robot: robot.status()["controller"] is None)
            robot.stop()
            robot.start()
    return {name: address for name, (address, _) in fleet.items()}


@pytest.fixture
def teacher(tmp_path, robots, fleet):
    """A laptop that knows all three, with their tokens."""
    laptop = Laptop(tmp_path / "teacher", draws=False)
    for name, address in robots.items():
        laptop.knows(name, address, fleet[name][1])
    return laptop


@pytest.fixture
def pupil(tmp_path, robots, fleet):
    """A laptop that knows all three, with the token of anna where a token usually is."""
    laptop = Laptop(tmp_path / "pupil", draws=False)
    for name, address in robots.items():
        laptop.knows(name, address)
    token = laptop.config / "token"
    token.write_text(fleet["anna"][1].read_text(encoding="ascii"), encoding="ascii")
    token.chmod(0o600)
    return laptop


def test_a_teacher_looks_at_all_and_kicks_each_and_all(teacher, robots, fleet):
    status, found = teacher.each("--brick", "all", "status")
    assert status == 0
    assert {name: one["state"] for name, one in found.items()} == dict.fromkeys(NAMES, "running")
    assert {name: one["brick"] for name, one in found.items()} == robots

    status, out, err = teacher.run("--brick", "bert", "kick", "--mode", "phase", "--json")
    assert status == 0, err
    assert json.loads(out)["brick"] == robots["bert"]

    teacher.draws = True
    status, found = teacher.each("--brick", "anna,carl", "kick", "--mode", "phase")
    assert status == 0
    assert {name: one["reversed"] for name, one in found.items()} == {"anna": True, "carl": True}
    for kind in ("log", "figure"):
        assert len({one[kind] for one in found.values()} - {None}) == 2

    status, out, err = teacher.run("--brick", "all", "record", "0.2")
    assert status == 0, err
    lines = out.splitlines()
    assert sorted(line.partition(":")[0] for line in lines) == sorted(NAMES)
    assert all("0 records missing" in line for line in lines)

    token = str(fleet["bert"][1])
    # An address leads to the robot's own token, too.
    assert teacher.run("--brick", robots["bert"], "start", KICK_TOKEN=token + "none")[0] == 1
    assert teacher.run("start", KICK_BRICK="bert")[0] == 1  # it runs already


def test_a_pupil_with_another_robots_token_looks_and_stops_but_moves_nothing(pupil, robots):
    status, found = pupil.each("--brick", "all", "status")
    assert (status, len(found)) == (0, 3)
    status, _, err = pupil.run("--brick", "all", "record", "0.1")
    assert status == 0
    assert "bert: the token on this computer is not that of the robot" in err
    assert "anna: the token" not in err

    status, found = pupil.each("--brick", "all", "kick", "--mode", "phase", "--now")
    assert status == 4
    assert found["anna"]["reversed"] is True
    for name in ("bert", "carl"):
        error = found[name]["error"]
        assert error["status"] == 4
        assert "the token of another robot" in error["message"]
        assert "kickctl robots add NAME" in error["hint"]

    assert pupil.run("--brick", "bert", "stop")[0] == 0
    status, found = pupil.each("--brick", "all", "status")
    assert [one["state"] for one in found.values()] == ["running", "stopped", "running"]


def test_a_teacher_takes_over_from_a_pupil_and_then_stops_all(teacher, robots, fleet, tmp_path):
    laptop = Laptop(tmp_path / "laptop")
    laptop.knows("bert", robots["bert"], fleet["bert"][1])
    kick = ("--name", "teacher@lab-1", "--brick", "bert", "kick", "--mode", "phase")
    with laptop.driving("bert", "pupil@lab-3") as pupil:
        status, out, err = teacher.run(*kick)
        assert (status, out) == (4, "")
        assert re.search(r"driven by 'pupil@lab-3' for \d+ ", err), err
        assert "--take-over" in err
        assert not list(teacher.folder.rglob("*.mcap"))
        # Nothing has changed for anybody.
        _, found = teacher.each("--brick", "all", "status")
        assert [one["controller"] for one in found.values()] == [None, "pupil@lab-3", None]

        status, out, err = teacher.run(*kick, "--take-over", "--json")
        assert status == 0, err
        assert json.loads(out)["reversed"] is True
        said = pupil.communicate(timeout=60)[0]
    assert pupil.returncode == 0
    warning, refusal = said.splitlines()
    assert "'teacher@lab-1' has taken over the robot" in warning
    assert "'teacher@lab-1' has taken over" in refusal
    # Neither the take-over nor the end of both programs stops a robot.
    status, found = teacher.each("--brick", "all", "status")
    assert {one["state"] for one in found.values()} == {"running"}
    assert {one["controller"] for one in found.values()} == {None}

    assert teacher.run("stop")[0] == 0
    _, found = teacher.each("--brick", "all", "status")
    assert [one["state"] for one in found.values()] == ["stopped"] * 3


def test_stop_without_a_name_stops_every_robot_and_says_which_it_did_not_reach(
    teacher, robots, tmp_path
):
    teacher.knows("gone", "tcp://127.0.0.1:1")
    status, found = teacher.each("stop")
    assert status == 3
    assert list(found) == [*NAMES, "gone"]
    assert [found[name]["state"] for name in NAMES] == ["stopped"] * 3
    assert "refuses the connection" in found["gone"]["error"]["message"]
    status, found = teacher.each("--brick", ",".join(NAMES), "status")
    assert {one["state"] for one in found.values()} == {"stopped"}
    # A hint is a command that works: it names that robot, and no other.
    _, _, err = teacher.run("--brick", "anna,bert", "kick", "--mode", "phase")
    for name in ("anna", "bert"):
        assert f"start it first: kickctl start --brick {name}\n" in err

    assert teacher.run("robots", "remove", "gone")[0] == 0
    status, out, _ = teacher.run("stop")
    assert status == 0
    for name in NAMES:
        assert f"{name}: motors stopped before tick" in out
    # One that is unknown keeps nobody from being stopped.
    assert teacher.run("--brick", "all", "start")[0] == 0
    status, found = teacher.each("--brick", "anan,bert", "stop")
    assert status == 2
    assert found["anan"]["error"]["hint"] == "did you mean anna?"
    assert found["bert"]["state"] == "stopped"
    # Who has named a robot in the shell has named one.
    status, out, _ = teacher.run("stop", KICK_BRICK="carl")
    assert (status, "carl:" in out, "motors stopped" in out) == (0, False, True)
    status, found = teacher.each("--brick", "all", "status")
    assert [one["state"] for one in found.values()] == ["running", "stopped", "stopped"]

    # Nor does a file of robots in which one line is wrong.
    wrong = Laptop(tmp_path / "wrong")
    wrong.config.mkdir(parents=True)
    text = (teacher.config / "robots.toml").read_text(encoding="utf-8")
    (wrong.config / "robots.toml").write_text(
        text + "[dora]\naddress = tcp://h\n", encoding="utf-8"
    )
    status, found = wrong.each("stop")
    assert status == 2
    assert [found[name]["state"] for name in NAMES] == ["stopped"] * 3
    assert "there may be more robots: the file" in found["robots.toml"]["error"]["message"]
    for robot in ("anna", re.search('tcp://[^"]+', text)[0]):
        assert wrong.run("--brick", robot, "status")[0] == 0

    nobody = Laptop(tmp_path / "nobody")
    for more in ({}, {"KICK_BRICK": "all"}):
        status, out, err = nobody.run("stop", **more)
        assert (status, out) == (2, "")
        assert "none has been stopped" in err
        assert "kickctl robots add" in err


def test_an_interrupt_reaches_every_robots_process(teacher):
    """The processes of the robots have groups of their own: the first one hands ^C on."""
    command = [sys.executable, "-m", "host", "--brick", "all", "record", "1000", "--json"]
    logs = teacher.folder / "logs"
    with subprocess.Popen(
        command,
        env=teacher.environment(),
        cwd=teacher.folder,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        while process.poll() is None and (not logs.exists() or len(list(logs.iterdir())) < 3):
            time.sleep(0.02)
        process.terminate()
        out = process.communicate(timeout=60)[0]
    assert process.returncode == 130
    found = json.loads(out)["robots"]
    assert [one["error"]["status"] for one in found.values()] == [130] * 3


def test_names_in_a_program(teacher, robots, fleet, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(teacher.folder / "config"))
    with connect("anna") as robot:
        assert robot.link.uri == robots["anna"]
        assert robot.kick("phase") > 0
    elsewhere = fleet["bert"][1]
    with (
        connect("anna", token=str(elsewhere)) as robot,
        pytest.raises(RefusedByRobot, match="the token of another robot"),
    ):
        robot.start()


@pytest.mark.parametrize(
    ("arguments", "words", "hint"),
    [
        (("--brick", "anna", "--brick", "bert", "status"), "--brick is given twice", "anna,bert"),
        (("--brick", "anna", "stop", "--brick", "bert"), "--brick is given twice", "anna,bert"),
        (("--brick", "anan", "status"), "no robot is named 'anan'", "did you mean anna?"),
        (("--brick", "anna,bert", "doctor"), "the verb doctor takes one robot", "name one"),
        (("--brick", "anna,anan", "status"), "no robot is named 'anan'", "did you mean anna?"),
        (("--brick", "all", "record", "1", "--out", "x"), "--out names one file", "leave --out"),
        (("--brick", "127.0.0.1:5531", "status"), "no address", "tcp://127.0.0.1:5531?"),
    ],
)
def test_what_names_no_robot_changes_nothing(tmp_path, capsys, arguments, words, hint):
    laptop = Laptop(tmp_path)  # whose folder for settings is that of the test
    for name in NAMES[:2]:
        laptop.knows(name, "tcp://127.0.0.1:1")
    status = main(arguments)
    out, err = capsys.readouterr()
    assert (status, out) == (2, "")
    assert words in err
    assert hint in err


def test_names_are_given_and_taken_on_the_command_line(tmp_path, capsys):
    token = tmp_path / "key"
    token.write_text("00" * 32, encoding="ascii")

    def run(*arguments):
        status = main(["robots", *arguments])
        return (status, *capsys.readouterr())

    assert run("list")[:2] == (0, "no robot has a name yet: kickctl robots add NAME ADDRESS\n")
    status, _, err = run("add", "anna", "tcp://h", "--token", str(token))
    assert status == 2
    assert f"\n  close it: chmod 600 {token}, then add the robot again" in err
    token.chmod(0o600)
    for unfit in ("missing", "."):
        status, _, err = run("add", "anna", "tcp://h", "--token", unfit)
        assert status == 2
        assert "  name a file that holds the robot's token, then add the robot again" in err
    assert run("add", "anna", "tcp://h", "--token", "key")[0] == 0
    assert run("add", "bert", "ssh://robot@h?port=7")[0] == 0
    assert json.loads(run("list", "--json")[1]) == {
        "robots": {
            "anna": {"address": "tcp://h", "token": str(token), "hardware_id": None},
            "bert": {"address": "ssh://robot@h?port=7", "token": None, "hardware_id": None},
        }
    }
    assert run("rename", "anna", "zoe")[0] == 0
    assert json.loads(run("remove", "bert", "--json")[1]) == {"removed": "bert", "token": None}
    assert run("list")[1] == f"zoe  tcp://h  (token {token})\n"
    for arguments, words in (
        (("add", "zoe", "tcp://i"), "already"),
        (("add", "carl", "127.0.0.1:1"), "did you mean tcp://127.0.0.1:1?"),
        (("add", "carl", "sim://"), "simulated robot"),
        (("add", "carl"), "takes NAME ADDRESS"),
        (("list", "zoe"), "takes no names"),
        (("remove", "zo"), "did you mean zoe?"),
        (("remove", "zoe", "--token", "key"), "belongs to"),
        (("--brick", "zoe", "list"), "--brick chooses a robot"),
    ):
        status, out, err = run(*arguments)
        assert (status, out) == (2, ""), arguments
        assert words in err
    assert list(json.loads(run("list", "--json")[1])["robots"]) == ["zoe"]
