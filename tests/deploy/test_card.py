"""A brick whose card is full or cannot be written.

The robot's program needs no disk; a deploy does, and says so before it touches anything.
"""

import os
import subprocess

import pytest

from tests.deploy.brick import needs_sshd, wait_until, write

pytestmark = needs_sshd


WHY = {"full": "No space left on device", "closed": "Is a directory"}


def close_card(brick, how):
    """Have the brick's card refuse what is written to it, and return what opens it again.

    Nothing else stops root: a folder where a file should be, or the device that is always full.
    """
    names = (".kickctl-probe", "kickctl/robot.pid", "kickctl/robot.log")
    paths = [brick.home / name for name in names]
    for path in paths:
        path.unlink(missing_ok=True)
        if how == "full":
            path.symlink_to("/dev/full")
        else:
            path.mkdir()

    def reopen():
        for path in paths:
            if path.is_symlink():
                path.unlink()
            elif path.is_dir():
                path.rmdir()

    return reopen


@pytest.fixture(params=["full", "closed"])
def how(request):
    return request.param


def test_a_deploy_is_refused_and_leaves_the_brick_alone(deployed, checkout, how):
    assert checkout.deploy()[0] == 0
    before = deployed.release(), deployed.pid(), deployed.releases()
    for arguments in ((), ("--rollback",)):
        kept = deployed.log()
        reopen = close_card(deployed, how)
        status, output = checkout.deploy(*arguments)
        reopen()
        assert status == 4, output
        assert f"the brick's card cannot be written: {WHY[how]}" in output
        assert "delete old files" in output
        write(deployed.kickctl / "robot.pid", f"{before[1]}\n")
        write(deployed.kickctl / "robot.log", kept)
        assert (deployed.release(), deployed.pid(), deployed.releases()) == before


def test_the_program_starts_with_the_brick_all_the_same(running, checkout, how):
    """As systemd starts it at boot: with its number and its log in memory."""
    running.stop_program()
    reopen = close_card(running, how)
    memory = running.folder / "brick" / "run"
    environment = {
        **os.environ,
        "HOME": str(running.home),
        "KICK_RUN": str(memory),
        "PATH": f"{running.bin}:{os.environ['PATH']}",
    }
    script = running.kickctl / "current" / "robot" / "service" / "brick.sh"
    with subprocess.Popen(["/bin/sh", script, "run", "--idle"], env=environment) as process:
        try:
            wait_until(
                lambda: [path for path in memory.rglob("robot.log") if "READY" in read(path)]
            )
            (log,) = memory.rglob("robot.log")
            status, output = checkout.deploy("--status")
            assert status == 0, output
            assert f"runs as process {process.pid}, READY tcp://127.0.0.1:" in output
            status, output = checkout.deploy("--logs")
            assert status == 0, output
            assert f"the log is in memory; the last lines of {log}:" in output
            assert "READY" in output
            reopen()
            status, output = checkout.deploy()
            assert status == 0, output
            assert process.wait(20) == 0
        finally:
            process.kill()
    assert running.runs() == running.release()
    assert f"the last lines of {running.kickctl}/robot.log:" in checkout.deploy("--logs")[1]


def read(path):
    return path.read_text(encoding="utf-8")


@pytest.mark.parametrize("tool", ["mv", "ln"])
def test_a_card_that_fails_in_the_change_over_brings_the_old_release_back(deployed, checkout, tool):
    release = deployed.release()
    deployed.replace(tool, f'case "$*" in *current*) exit 1;; esac\nexec /bin/{tool} "$@"')
    status, output = checkout.deploy()
    assert status == 1, output
    assert f"{release} runs again" in output
    assert (deployed.runs(), deployed.release()) == (release, release)


def test_what_the_bricks_shell_ends_with_is_never_taken_for_wrong_use(deployed, checkout):
    """A shell that cannot write a file ends with 2."""
    lock = deployed.kickctl / "lock"
    lock.unlink()
    lock.mkdir()
    pid = deployed.pid()
    status, output = checkout.deploy()
    assert status == 1, output
    assert "the brick's shell ended with status 2" in output
    assert deployed.pid() == pid


def test_a_battery_and_a_disk_that_give_no_number_are_no_reason_to_refuse(stocked, checkout):
    write(stocked.sysfs / "power_supply" / "lego-ev3-battery" / "voltage_now", "full\n")
    status, output = checkout.deploy()
    assert status == 0, output
    assert "battery not measured" in output
