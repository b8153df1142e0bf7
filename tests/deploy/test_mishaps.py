"""A brick that is not fit, and programs on it that hang, do not end, or are not the robot's."""

import os
import signal
import subprocess

import pytest

from tests.deploy.brick import needs_sshd, write

pytestmark = needs_sshd


def unharmed(brick, release):
    """Whether `release` runs, as it did, and nothing else is left."""
    return (brick.runs(), brick.release(), brick.releases()) == (release, release, [release])


@pytest.mark.parametrize(
    ("program", "script", "words"),
    [
        ("python3", "echo 3.4.2; exit 1", ("3.4.2", "3.5 or newer", "ev3dev-stretch")),
        ("python3", "exit 127", ("missing", "3.5 or newer")),
        (
            "df",
            (
                'printf "Filesystem 1024-blocks Used Available Capacity Mounted\\n/dev/root 99 99'
                ' 8123 99%% /\\n"'
            ),
            ("8 MB left", "delete"),
        ),
    ],
)
def test_a_brick_that_is_not_fit_is_refused_and_left_alone(
    deployed, checkout, program, script, words
):
    release, pid = deployed.release(), deployed.pid()
    deployed.replace(program, script)
    status, output = checkout.deploy()
    assert status == 4
    for word in words:
        assert word in output
    assert deployed.pid() == pid
    assert unharmed(deployed, release)


@pytest.mark.parametrize(
    ("technology", "microvolts", "status"),
    [
        ("Li-ion", 6490000, 4),
        ("Li-ion", 6510000, 0),
        ("Unknown", 5490000, 4),
        ("Unknown", 6000000, 0),
        ("NiMH", None, 0),
    ],
)
def test_an_empty_battery_is_refused(stocked, checkout, technology, microvolts, status):
    battery = stocked.sysfs / "power_supply" / "lego-ev3-battery"
    write(battery / "technology", technology + "\n")
    if microvolts is None:
        (battery / "voltage_now").unlink()
    else:
        write(battery / "voltage_now", f"{microvolts}\n")
    found, output = checkout.deploy()
    assert found == status, output
    assert ("charge it" in output) == (status == 4)
    assert (stocked.runs() is None) == (status == 4)


def test_a_program_that_hangs_is_told_and_a_deploy_ends_it(brick, checkout):
    health = checkout.folder / "robot" / "health.py"
    health.write_text(
        health.read_text(encoding="utf-8").replace("PATIENCE_S = 20.0", "PATIENCE_S = 1.0"),
        encoding="utf-8",
    )
    checkout.deploy()
    pid = brick.pid()
    os.kill(pid, signal.SIGSTOP)
    status, output = checkout.deploy("--status")
    assert status == 5
    for words in ("it hangs", "the watchdog stops the motors", "deploy again to end it"):
        assert words in output
    status, output = checkout.deploy()
    assert status == 0, output
    assert pid not in brick.processes()
    assert brick.runs() == brick.release()


def test_a_program_that_does_not_listen_to_sigterm_is_killed(brick, checkout):
    checkout.change(
        "program",
        "\nsignal.signal = lambda number, handler: None\nsignal.pthread_sigmask(signal.SIG_BLOCK,"
        " [signal.SIGTERM])\n",
    )
    checkout.deploy()
    stubborn = brick.pid()
    os.kill(stubborn, signal.SIGTERM)
    checkout.change()
    status, output = checkout.deploy()
    assert status == 0, output
    assert stubborn not in brick.processes()
    assert brick.runs() == brick.release()


def test_a_process_that_only_has_the_old_number_is_left_alone(running, checkout):
    running.stop_program()
    with subprocess.Popen(["sleep", "1000"]) as stranger:
        try:
            write(running.kickctl / "robot.pid", f"{stranger.pid}\n")
            assert checkout.deploy()[0] == 0
            assert stranger.poll() is None
        finally:
            stranger.kill()
    assert running.runs() == running.release()


def test_a_program_that_has_yet_to_write_its_number_is_waited_for(stocked, checkout):
    """Its shell creates robot.pid and then writes to it: deploy may look in between."""
    stocked.replace("setsid", ': >~/kickctl/robot.pid; sleep 1; exec /usr/bin/setsid "$@"')
    status, output = checkout.deploy()
    assert status == 0, output
    assert stocked.runs() == stocked.release()


def test_two_deploys_at_once_do_not_get_into_each_others_way(deployed, checkout):
    with checkout.deploying() as one, checkout.deploying() as other:
        outputs = [process.communicate(timeout=100)[0] for process in (one, other)]
    assert 0 in (one.returncode, other.returncode), outputs
    assert deployed.runs() == deployed.release()
    status, output = checkout.deploy()
    assert status == 0, output
