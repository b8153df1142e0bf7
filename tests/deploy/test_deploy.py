"""deploy.sh against a real sshd.

What it does when all is well, and that whatever goes wrong leaves a brick that works.
"""

import shutil
import stat
import subprocess

import pytest

from tests.deploy.brick import needs_sshd, write

pytestmark = needs_sshd


def test_the_first_deploy_brings_a_whole_release_and_starts_it(brick, checkout):
    status, output = checkout.deploy()
    assert status == 0, output
    assert brick.runs() == brick.release() == brick.releases()[0]
    assert brick.release("previous") is None
    assert f"kickctl --brick '{brick.uri()}' start" in output
    current = brick.kickctl / "current"
    assert sorted(path.name for path in (current / "robot").glob("*.py")) == sorted(
        path.name for path in (checkout.folder / "robot").glob("*.py")
    )
    assert {path.name for path in current.iterdir()} == {"robot", "SHA256SUMS"}
    kept = {path.name.partition(".")[0] for path in (current / "robot" / "__pycache__").iterdir()}
    assert kept == {path.stem for path in (current / "robot").glob("*.py")} | {"fingerprint"}


def test_host_and_brick_share_a_token_that_nobody_else_can_read(card):
    brick, checkout = card
    theirs = brick.home / ".config" / "kickctl" / "token"
    assert len(bytes.fromhex(checkout.token.read_text(encoding="ascii"))) == 32
    assert theirs.read_text(encoding="ascii") == checkout.token.read_text(encoding="ascii")
    for path in (checkout.token, theirs):
        assert stat.S_IMODE(path.stat().st_mode) == 0o600


def test_a_second_host_takes_over_the_bricks_token(running, checkout):
    first = checkout.token.rename(checkout.token.with_name("first"))
    status, output = checkout.deploy()
    assert status == 0, output
    assert checkout.token.read_text(encoding="ascii") == first.read_text(encoding="ascii")
    assert stat.S_IMODE(checkout.token.stat().st_mode) == 0o600
    assert (
        checkout.kickctl("--brick", running.uri(), "clear")[0] == 5
    )  # understood as a command: the motors are not there


def test_a_token_that_is_open_to_others_is_not_sent(stocked, checkout):
    write(checkout.token, "00" * 32 + "\n", 0o644)
    status, output = checkout.deploy()
    assert status == 1
    assert "chmod 600" in output
    assert not (stocked.home / ".config").exists()
    assert stocked.runs() is None


def test_a_second_deploy_of_the_same_keeps_the_release_and_starts_it_anew(running, checkout):
    first = running.release(), running.pid()
    status, output = checkout.deploy()
    assert status == 0, output
    assert "is there already" in output
    assert running.runs() == running.release() == first[0]
    assert running.pid() != first[1]
    assert running.release("previous") is None
    assert first[1] not in running.processes()


def test_upgrade_then_rollback_and_forth_again(deployed, checkout):
    old = deployed.release()
    status, output = checkout.deploy()
    assert status == 0, output
    new = deployed.release()
    assert new != old
    assert (deployed.runs(), deployed.release("previous")) == (new, old)
    status, output = checkout.deploy("--rollback")
    assert status == 0, output
    assert (deployed.runs(), deployed.release(), deployed.release("previous")) == (old, old, new)
    assert checkout.deploy("--rollback")[0] == 0
    assert (deployed.runs(), deployed.release("previous")) == (new, old)


def test_whoever_may_stand_beside_the_robot_is_warned_of_its_wheels(stocked, checkout):
    assert "wheels will turn" in checkout.deploy()[1]
    checkout.change()
    assert (
        "wheels will turn"
        not in checkout.deploy(
            KICK_ROBOT_ARGS=f"--idle --sysfs {stocked.sysfs} --host 127.0.0.1 --port 0"
        )[1]
    )
    assert "wheels will turn" not in checkout.deploy("--rollback")[1]
    checkout.deploy()
    status, output = checkout.deploy("--rollback")
    assert status == 0
    assert "wheels will turn" in output
    assert "the wheels turn" in checkout.deploy("--dry-run", "--rollback")[1]


def test_a_robot_in_fault_is_told_with_what_to_do(stocked, checkout):
    status, output = checkout.deploy()
    assert status == 0  # as --help says: another release would not bring the motor
    assert "left motor (outB): there is none" in output
    commands = output.partition("robot is in fault")[2].splitlines()
    assert [line.split()[-1] for line in commands[1:3]] == ["clear", "start"]
    assert "kick --mode" not in output
    assert "kickctl clear" in checkout.deploy("--status")[1]


@pytest.mark.parametrize("installed", [False, True])
def test_the_closing_words_can_be_typed_as_they_stand(stocked, checkout, installed):
    environment = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin"}
    if installed:
        environment["PATH"] += f":{checkout.bin}"
        write(checkout.bin / "kickctl", "#!/bin/sh\necho $*\n", 0o755)
    else:
        assert "make setup" in checkout.deploy(**environment)[1]
        write(checkout.folder / ".venv" / "bin" / "kickctl", "#!/bin/sh\necho $*\n", 0o755)
    output = checkout.deploy(**environment)[1]
    assert "make setup" not in output
    (hint,) = [line for line in output.splitlines() if line.endswith("start")]
    done = subprocess.run(
        ["/bin/sh", "-c", hint], env=environment, capture_output=True, text=True, check=True
    )
    robot = "brick" if installed else stocked.uri()  # an installed kickctl gives it a name
    assert done.stdout == f"--brick {robot} start\n"


def test_only_the_release_before_is_kept(deployed, checkout):
    seen = []
    for _ in range(2):
        assert checkout.deploy()[0] == 0
        seen.append(deployed.release())
        checkout.change()
    assert deployed.releases() == sorted(seen)


def test_rollback_of_a_first_release_is_refused(brick, checkout):
    status, output = checkout.deploy("--rollback")
    assert status == 1
    assert "to go back to" in output
    assert "cannot open" not in output
    assert list(brick.home.iterdir()) == []
    checkout.deploy()
    status, output = checkout.deploy("--rollback")
    assert status == 1
    assert "no release before" in output
    assert brick.runs() == brick.release()


def test_every_motor_is_reset_whatever_its_port(stocked, checkout):
    motors = [stocked.sysfs / "tacho-motor" / f"motor{number}" / "command" for number in (0, 3)]
    for motor in motors:
        write(motor, "")
    status, output = checkout.deploy()
    assert status == 0, output
    assert [motor.read_text(encoding="ascii") for motor in motors] == ["reset\n", "reset\n"]


def test_arguments_stay_until_others_are_given(running, checkout):
    environment = checkout.environment()
    checkout.environment = lambda **more: {
        **environment,
        **{name: value for name, value in more.items() if name != "KICK_ROBOT_ARGS"},
    }
    status, output = checkout.deploy()
    assert status == 0, output
    said = checkout.kickctl("--brick", running.uri(), "status", "--json")[1]
    assert '"seed": 5,' in said  # that of the deploy before


def test_status_and_logs(brick, checkout):
    status, output = checkout.deploy("--status")
    assert status == 5
    assert "nothing was deployed" in output
    assert checkout.deploy("--logs")[0] == 1
    checkout.deploy()
    status, output = checkout.deploy("--status")
    assert status == 0
    assert brick.release() in output
    assert "no: deploy with --service" in output
    assert "left motor (outB): there is none" in output
    assert "READY tcp://127.0.0.1:" in checkout.deploy("--logs")[1]
    brick.stop_program()
    status, output = checkout.deploy("--status")
    assert status == 5
    assert "does not run" in output


def test_a_dry_run_connects_to_nothing_and_writes_nothing(checkout, brick):
    status, output = checkout.deploy("--dry-run", to="robot@nowhere.invalid")
    assert status == 0
    assert "robot/loop.py" in output
    assert brick.releases() == []
    assert not checkout.token.exists()
    for verb in ("--rollback", "--no-service", "--status", "--logs"):
        status, output = checkout.deploy("--dry-run", verb, to="robot@nowhere.invalid")
        assert (status, "would connect to robot@nowhere.invalid" in output) == (0, True)


@pytest.mark.parametrize(
    "arguments",
    [
        ("--fly",),
        ("--status", "--logs"),
        ("--rollback", "--service"),
        ("--service", "--no-service"),
        ("another",),
        ("",),
        ("-oProxyCommand=touch x",),
    ],
)
def test_wrong_use_is_told_before_anything_is_done(checkout, brick, arguments):
    status, output = checkout.deploy(*arguments)
    assert status == 2
    assert output.startswith("deploy: ")
    assert len(output.splitlines()) == 2
    assert brick.releases() == []


def test_help_names_every_option_and_exit_status(checkout, brick):
    status, output = checkout.deploy("--help")
    assert status == 0
    for word in (
        "--service",
        "--no-service",
        "--rollback",
        "--status",
        "--logs",
        "--dry-run",
        "KICK_ROBOT_ARGS",
        "KICK_TOKEN",
        "KICK_SSH_OPTIONS",
        "5 no robot's",
    ):
        assert word in output


def test_nothing_but_the_robots_own_files_is_sent(brick, checkout):
    write(checkout.folder / "robot" / "secret.txt", "")
    write(checkout.folder / "robot" / "__pycache__" / "stale.cpython-35.pyc", "")
    shutil.copy(checkout.folder / "deploy.sh", checkout.folder / "robot" / "notes.sh")
    checkout.deploy()
    sent = [
        path
        for path in (brick.kickctl / "current").rglob("*")
        if path.suffix in (".txt", ".sh") or path.name.startswith("stale")
    ]
    assert sorted(path.name for path in sent) == ["brick.sh", "change.sh"]
