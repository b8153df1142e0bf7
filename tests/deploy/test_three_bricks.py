"""Three bricks with names, each behind a sshd of its own, and one laptop."""

import json
from contextlib import ExitStack

import pytest

from tests.cli.test_desk import desk_robot
from tests.deploy.brick import Brick, needs_sshd
from tests.laptop import Laptop

NAMES = ("anna", "bert", "carl")


@pytest.fixture
def bricks(tmp_path):
    """Three bricks: {name: (address of the robot that runs there, its token)}.

    The file `ssh_config` says how ssh reaches them.
    """
    found, settings = {}, []
    with ExitStack() as stack:
        for name in NAMES:
            brick = Brick(tmp_path / name, name)
            stack.callback(brick.shut_down)
            brick.boot()
            settings.append(brick.ssh_config.read_text(encoding="utf-8"))
            settings[-1] = settings[-1].replace("Host brick", f"Host {name}")
            uri, _ = stack.enter_context(desk_robot(tmp_path / name))
            port = uri.rpartition(":")[2]
            found[name] = f"ssh://{name}?port={port}", tmp_path / name / "token"
        (tmp_path / "ssh_config").write_text("\n".join(settings), encoding="utf-8")
        yield found


def laptop_in(folder, name):
    """A laptop whose ssh reaches the bricks."""
    options = f"-F {folder / 'ssh_config'}"
    return Laptop(folder / name, draws=False, KICK_SSH_OPTIONS=options)


@pytest.fixture
def teacher(bricks, tmp_path):
    """A laptop that knows all three, with their tokens."""
    laptop = laptop_in(tmp_path, "teacher")
    for name, (address, token) in bricks.items():
        laptop.knows(name, address, token)
    return laptop


@pytest.fixture
def pupil(bricks, tmp_path):
    """A laptop that knows all three, with the token of anna for each."""
    laptop = laptop_in(tmp_path, "pupil")
    for name, (address, _) in bricks.items():
        laptop.knows(name, address, bricks["anna"][1])
    return laptop


def states(found):
    return [one["state"] for one in found.values()]


@needs_sshd
def test_names_lead_to_three_bricks_over_ssh_and_a_stop_reaches_all(bricks, teacher, pupil):
    status, found = pupil.each("--brick", "all", "status")
    assert (status, states(found)) == (0, ["running"] * 3)
    assert [one["brick"] for one in found.values()] == [address for address, _ in bricks.values()]

    status, found = teacher.each("--brick", "all", "kick", "--mode", "phase")
    assert (status, [one["reversed"] for one in found.values()]) == (0, [True] * 3)
    status, found = pupil.each("--brick", "all", "start")
    assert status == 4
    assert [one["error"]["status"] for one in found.values()] == [1, 4, 4]  # anna runs already

    kick = ("--name", "teacher@lab-1", "--brick", "anna", "kick", "--mode", "phase")
    with pupil.driving("anna", "pupil@lab-3") as driver:
        status, _, err = teacher.run(*kick)
        assert (status, "driven by 'pupil@lab-3' for " in err) == (4, True), err
        status, out, err = teacher.run(*kick, "--take-over", "--json")
        assert status == 0, err
        assert json.loads(out)["brick"] == bricks["anna"][0]
        said = driver.communicate(timeout=60)[0]
    assert said.count("'teacher@lab-1' has taken over") == 2
    status, found = teacher.each("--brick", "all", "status")
    assert (status, states(found)) == (0, ["running"] * 3)

    # A stop needs no token.
    status, found = pupil.each("stop")
    assert (status, states(found)) == (0, ["stopped"] * 3)
    status, found = teacher.each("--brick", "all", "status")
    assert (status, states(found)) == (0, ["stopped"] * 3)
