"""The robot's program as a service.

Deploy.sh puts it in place, and the unit's own words make the motors stop however it ends.
"""

import getpass
import os
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.deploy.brick import ROOT, charged, deployed_once, needs_sshd, wait_until, write

pytestmark = needs_sshd


# Most commands only have to be noted.
SYSTEMCTL = f"""\
echo "$*" >>"$KICK_ETC/systemd/systemctl.log"
case $1 in start | stop) ;; *) exit ;; esac
exec {sys.executable} -S {Path(__file__).parent / "systemd.py"} $1"""


def with_systemd(brick):
    """The brick, with a motor and systemd."""
    write(brick.sysfs / "tacho-motor" / "motor0" / "command", "")
    (brick.etc / "systemd" / "system").mkdir(parents=True)
    brick.replace("systemctl", SYSTEMCTL)
    return brick


@pytest.fixture
def ready(brick):
    """A brick with a motor and systemd, whose service ends with the test."""
    yield with_systemd(brick)
    manager = brick.etc / "systemd" / "system" / "manager.pid"
    if manager.exists():
        os.kill(int(manager.read_text(encoding="ascii")), signal.SIGKILL)


@pytest.fixture(scope="session")
def served_card(tmp_path_factory):
    """A brick that was deployed to once, as a service, and is off."""
    brick = with_systemd(charged(tmp_path_factory.mktemp("served")))
    with deployed_once(brick, "--service"):
        brick.do("systemctl stop kickctl")
    return brick


@pytest.fixture
def served(ready, checkout, served_card):
    """A brick with systemd, to which the program was deployed as a service, after its start."""
    ready.take_card(served_card)
    ready.do("systemctl start kickctl")
    wait_until(lambda: (unit(ready).parent / "notified").exists() and notified(ready))
    return ready


def unit(brick):
    return brick.etc / "systemd" / "system" / "kickctl.service"


def commands(brick):
    return (brick.etc / "systemd" / "systemctl.log").read_text(encoding="ascii").splitlines()


def notified(brick):
    return (unit(brick).parent / "notified").read_text(encoding="ascii").splitlines()


def resets(brick):
    """How the motor's command file ends up; emptied for the next time."""
    command = brick.sysfs / "tacho-motor" / "motor0" / "command"
    text = command.read_text(encoding="ascii")
    command.write_text("", encoding="ascii")
    return text


def test_a_deploy_as_a_service_has_systemd_take_it_and_tells_the_network_the_port(ready, checkout):
    status, output = checkout.deploy("--service")
    assert status == 0, output
    assert commands(ready)[:2] == ["daemon-reload", "enable kickctl"]
    fields = dict(
        re.findall(
            r"<(\S+)>(.*)</\1>",
            (ready.etc / "avahi" / "services" / "kickctl.service").read_text(encoding="utf-8"),
        )
    )
    assert fields["type"] == "_kickctl._tcp"
    assert fields["port"] == ready.uri().partition("port=")[2]


def test_the_program_starts_with_the_brick_and_tells_systemd_that_it_lives(served, checkout):
    assert served.runs() == served.release()
    wait_until(lambda: notified(served)[-1].endswith("WATCHDOG=1"))
    assert notified(served)[0] == f"{served.pid()} READY=1"
    assert "the program starts with the brick" in checkout.deploy("--status")[1]
    output = checkout.deploy("--service")[1]
    assert "wheels will turn" not in output  # it starts with its motors off


def test_upgrade_and_rollback_go_through_systemd(served, checkout):
    old = served.release()
    checkout.change()
    status, output = checkout.deploy()
    assert status == 0, output
    assert served.runs() == served.release() != old
    assert commands(served).count("stop kickctl") == 1
    assert commands(served).count("enable kickctl") == 0  # it is
    checkout.change("params", "\nraise RuntimeError('no')\n")
    assert checkout.deploy()[0] == 1
    assert checkout.deploy("--rollback")[0] == 0
    assert served.runs() == old


def is_no_service(brick):
    """Whether nothing of a service is left, and a program runs that systemd did not start."""
    left = [
        path.name
        for folder in (unit(brick).parent, brick.etc / "avahi" / "services")
        for path in folder.glob("kickctl*")
    ]
    manager = unit(brick).parent / "manager.pid"
    return (
        left == []
        and not manager.exists()
        and not list(brick.kickctl.glob("*.new"))
        and brick.runs() is not None
    )


@pytest.mark.parametrize(
    "systemctl",
    [f'[ "$1" != {verb} ] || exit 1\n{SYSTEMCTL}' for verb in ("daemon-reload", "enable", "start")]
    + ["exit 1"],
    ids=["daemon-reload", "enable", "start", "everything"],
)
def test_a_first_service_that_systemd_does_not_take_leaves_the_release_before_as_it_was(
    ready, running, checkout, systemctl
):
    old = ready.release()
    ready.replace("systemctl", systemctl)
    checkout.change()
    status, output = checkout.deploy("--service")
    assert status == 1, output
    assert "systemd did not" in output
    assert f"{old} runs again" in output
    assert is_no_service(ready)
    assert ready.runs() == ready.release() == old
    status, output = checkout.deploy()
    assert status == 0, output
    assert is_no_service(ready)
    assert ready.runs() == ready.release() != old


def test_a_first_release_of_all_that_systemd_does_not_take_is_no_service(ready, checkout):
    ready.replace("systemctl", "exit 1")
    assert checkout.deploy("--service")[0] == 5
    assert not unit(ready).exists()
    status, output = checkout.deploy()
    assert status == 0, output
    assert is_no_service(ready)


def test_a_bad_release_does_not_become_a_service(ready, running, checkout):
    old = ready.release()
    checkout.change("params", "\nraise RuntimeError('no')\n")
    status, output = checkout.deploy("--service")
    assert status == 1, output
    assert is_no_service(ready)
    assert ready.runs() == old
    assert commands(ready)[-2:] == ["disable kickctl", "daemon-reload"]


def test_a_bad_release_of_a_service_takes_its_unit_file_with_it(served, checkout):
    old, text = served.release(), unit(served).read_bytes()
    template = checkout.folder / "robot" / "service" / "kickctl.service"
    template.write_text(
        template.read_text(encoding="utf-8").replace("run --idle", "run --fly"), encoding="utf-8"
    )
    status, output = checkout.deploy("--service")
    assert status == 1, output
    assert unit(served).read_bytes() == text
    assert served.runs() == old


def test_no_service_undoes_it_and_the_release_stays(served, checkout):
    release, pid = served.release(), served.pid()
    status, output = checkout.deploy("--no-service")
    assert status == 0, output
    assert is_no_service(served)
    assert served.runs() == served.release() == release
    assert served.pid() != pid
    assert "wheels will turn" in output
    assert "disable kickctl" in commands(served)
    status, output = checkout.deploy("--no-service")
    assert (status, "no service" in output) == (1, True)
    status, output = checkout.deploy()
    assert status == 0, output
    assert is_no_service(served)


def test_no_service_of_a_brick_that_was_never_deployed_to(brick, checkout):
    status, output = checkout.deploy("--no-service")
    assert (status, "no service" in output) == (1, True)
    assert list(brick.home.iterdir()) == []


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSEGV, signal.SIGSTOP])
def test_whatever_ends_the_program_resets_the_motors_and_starts_it_anew(served, number):
    resets(served)
    pid = served.pid()
    os.kill(pid, number)  # one that hangs is aborted when it misses to say that it lives
    wait_until(lambda: served.pid() not in (None, pid))
    assert resets(served).endswith("reset\n")
    wait_until(lambda: f"{served.pid()} READY=1" in notified(served))


def test_without_the_administrators_password_nothing_is_touched(served, checkout):
    served.replace("id", '[ "$1" = -un ] && echo robot || echo 1000')
    served.replace("sudo", "exit 1")
    release, pid = served.release(), served.pid()
    checkout.change()
    status, output = checkout.deploy()
    assert status == 1
    assert "at a terminal" in output
    assert checkout.deploy("--no-service")[0] == 1
    assert (served.release(), served.pid()) == (release, pid)
    assert unit(served).exists()
    served.replace("sudo", 'exec "$@"')
    status, output = checkout.deploy()
    assert status == 0, output


def test_a_program_that_ends_well_is_not_started_again(served):
    resets(served)
    pid = served.pid()
    served.stop_program()
    wait_until(lambda: not (unit(served).parent / "manager.pid").exists())
    assert f"{pid} STOPPING=1" in notified(served)
    assert resets(served).endswith("reset\n")
    assert served.pid() is None


@pytest.mark.skipif(
    shutil.which("systemd-analyze") is None,
    reason="there is no systemd-analyze: apt-get install systemd",
)
def test_systemd_understands_every_line_of_the_unit(tmp_path):
    text = (ROOT / "robot" / "service" / "kickctl.service").read_text(encoding="utf-8")
    for name, value in (
        ("@USER@", getpass.getuser()),
        ("@ROOT@", "/home/robot/kickctl"),
        ("@CLASS@", "/sys/class"),
    ):
        text = text.replace(name, value)
    write(tmp_path / "kickctl.service", text)
    done = subprocess.run(
        ["systemd-analyze", "verify", "--man=no", tmp_path / "kickctl.service"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_the_unit_uses_nothing_that_the_bricks_systemd_does_not_know():
    """What came after systemd 232, of what such a unit might want."""
    text = (ROOT / "robot" / "service" / "kickctl.service").read_text(encoding="utf-8")
    for later in (
        "append:",
        "truncate:",
        "ExecCondition",
        "RestartMode",
        "RestartSteps",
        "OOMPolicy",
        "TimeoutStartFailureMode",
    ):
        assert later not in text
