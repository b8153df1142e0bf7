"""ssh:// as a way to a robot."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from host.client.robot import Robot, connect
from host.client.stop import stop_robot
from host.errors import NoLink, RobotFault, WrongUse
from host.link.addresses import make_link
from host.link.ssh import SshLink
from host.util.installation import deploy_command
from tests.deploy.brick import ROOT, free_port, needs_sshd, write
from tests.sysfs.mount import ended, mounted, needs_mount, started


@pytest.fixture
def desk(tmp_path):
    """The port of a desk robot on this machine."""
    process, uri = started(
        "sim_motor", "--port", "0", "--seed", "3", "--token", str(tmp_path / "token")
    )
    yield uri.rpartition(":")[2]
    ended(process)


@pytest.fixture
def through(brick, monkeypatch):
    """Have ssh:// find the brick from within the test."""
    monkeypatch.setenv("KICK_SSH_OPTIONS", f"-F {brick.ssh_config}")


def tunnels():
    """Numbers of the ssh processes that this one has started."""
    children = Path(f"/proc/self/task/{os.getpid()}/children").read_text(encoding="ascii").split()
    return [
        int(child)
        for child in children
        if Path(f"/proc/{child}/comm").read_text(encoding="ascii").strip() == "ssh"
    ]


def patient_kick(checkout, brick):
    """Kick a robot that bears a silent host, as a busy machine, too, keeps it from speaking."""
    robot = ("--brick", brick.uri())
    status, _, err = checkout.kickctl(*robot, "params", "set", "link_loss_s=10", "--json")
    assert status == 0, err
    return checkout.kickctl(*robot, "kick", "--mode", "phase", "--ticks", "4", "--json")


@needs_sshd
@needs_mount
def test_deploy_then_a_kick_through_the_tunnel_reverses_the_wheels(brick, checkout, tmp_path):
    """The whole way: deploy.sh, the robot on simulated motors, kickctl over ssh, a log."""
    with mounted(tmp_path / "motors", "--seed", "4") as motors:
        brick.sysfs.rename(tmp_path / "unused")
        brick.sysfs.symlink_to(motors)
        try:
            status, output = checkout.deploy()
            assert status == 0, output
            assert "running (started), battery" in output
            assert f"kickctl --brick '{brick.uri()}' kick --mode phase" in output
            status, out, err = patient_kick(checkout, brick)
            assert status == 0, err
            result = json.loads(out)
            assert result["reversed"] is True
            status, out, err = checkout.kickctl("log", "replay", result["log"], "--json")
            assert (status, json.loads(out)["exact"]) == (0, True), err
            checkout.change()
            assert checkout.deploy()[0] == 0
            status, _, err = patient_kick(checkout, brick)
            assert status == 0, err
            assert checkout.deploy("--rollback")[0] == 0
            assert checkout.kickctl("--brick", brick.uri(), "stop")[0] == 0
        finally:
            if brick.pid() is not None:
                brick.stop_program()


@needs_sshd
def test_a_tunnel_is_gone_with_the_link(desk, through, tmp_path):
    before = tunnels()
    with connect(f"ssh://brick?port={desk}", token=str(tmp_path / "token")) as robot:
        assert len(tunnels()) == len(before) + 1
        assert robot.kick("phase", ticks=4) > 0
        assert robot.record(0.5).missing() == []
    assert tunnels() == before


@needs_sshd
def test_a_robot_drives_on_when_a_cell_connects_again(desk, through, tmp_path):
    uri, token = f"ssh://brick?port={desk}", str(tmp_path / "token")
    robot = connect(uri, token=token, name="nb")
    robot.lease()
    for _ in range(2):
        robot = connect(uri, token=token, name="nb")
        robot.wait(1.0)  # twice as long as the robot keeps the lease of a silent host
        assert robot.drives
        assert robot.status()["state"] == "running"
    assert len(tunnels()) == 1
    robot.close()


@needs_sshd
def test_a_tunnel_that_dies_is_dug_anew_and_no_tick_is_lost(desk, through, tmp_path):
    uri, token = f"ssh://brick?port={desk}", str(tmp_path / "token")
    with connect(uri, token=token) as robot, robot.recording() as log:
        robot.wait(0.3)
        os.kill(tunnels()[-1], signal.SIGKILL)
        robot.wait(1.0)
    assert log.missing() == []


@needs_sshd
def test_an_interrupt_at_the_terminal_leaves_the_tunnel_to_stop_the_motors_through(
    desk, through, tmp_path
):
    with connect(f"ssh://brick?port={desk}", token=str(tmp_path / "token")) as robot:
        (tunnel,) = tunnels()
        os.kill(tunnel, signal.SIGINT)
        assert robot.stop() > 0
        assert tunnels() == [tunnel]


@needs_sshd
def test_a_brick_whose_robot_does_not_run(brick, through):
    with pytest.raises(NoLink, match="no robot answers at ssh://brick") as caught:
        connect(f"ssh://brick?port={free_port()}")
    assert deploy_command() in caught.value.hint


@needs_sshd
@pytest.mark.parametrize("state", ["", "running"])
def test_a_stop_does_not_wait_for_a_program_that_hangs(
    brick, through, tmp_path, monkeypatch, state
):
    """The time counts from the login on; then the brick's kernel switches the motors off."""
    monkeypatch.setattr(SshLink, "answer_s", 3600.0)
    monkeypatch.setattr(Robot, "answer_s", 1.0)
    motor = brick.sysfs / "tacho-motor" / "motor0"
    write(motor / "command", "run-direct")
    write(motor / "state", state)
    process, uri = started("sim_motor", "--port", "0", "--token", str(tmp_path / "token"))
    process.send_signal(signal.SIGSTOP)
    link = make_link(f"ssh://brick?port={uri.rpartition(':')[2]}")
    try:
        with pytest.raises(NoLink if state else RobotFault) as caught:
            stop_robot(link, patience_s=1.0)
        with pytest.raises(NoLink, match="no robot answers at ssh://"):
            connect(link.uri, token=str(tmp_path / "token"))
    finally:
        process.send_signal(signal.SIGCONT)
        ended(process)
    assert (motor / "command").read_text(encoding="ascii") == "reset\n"
    words = "motors may be on: motor0 reads 'running'" if state else "says: the motors are off"
    assert words in caught.value.message
    assert tunnels() == []


@needs_sshd
def test_a_stop_switches_the_motors_off_if_no_program_runs(brick, through):
    motor = brick.sysfs / "tacho-motor" / "motor0"
    write(motor / "command", "run-direct")
    write(motor / "state", "")
    with pytest.raises(RobotFault, match="says: the motors are off"):
        stop_robot(make_link(f"ssh://brick?port={free_port()}"))
    assert (motor / "command").read_text(encoding="ascii") == "reset\n"


@needs_sshd
def test_no_brick_there(brick, through):
    brick.reach_through(1)
    with pytest.raises(NoLink, match="Connection refused") as caught:
        connect("ssh://brick")
    assert "address on its screen" in caught.value.hint


@needs_sshd
def test_a_brick_that_one_may_not_log_in_to(brick, through):
    (brick.folder / "user_key.pub").write_text("", encoding="ascii")
    with pytest.raises(NoLink, match="Permission denied") as caught:
        connect("ssh://brick")
    assert "ssh://robot@brick" in caught.value.hint


@needs_sshd
def test_a_brick_that_is_not_known(brick, through):
    (brick.folder / "known_hosts").write_text("", encoding="ascii")
    with pytest.raises(NoLink, match="Host key verification failed") as caught:
        connect("ssh://brick")
    assert "say yes" in caught.value.hint


@needs_sshd
def test_a_brick_with_a_new_card(brick, through):
    """What ssh says of it is long: a warning between rows of @, and the reason at its end."""
    key = (brick.folder / "user_key.pub").read_text(encoding="utf-8")
    (brick.folder / "known_hosts").write_text(f"[127.0.0.1]:{brick.port} {key}", encoding="utf-8")
    with pytest.raises(NoLink) as caught:
        connect("ssh://brick")
    assert caught.value.message.endswith("Host key verification failed.")
    assert "@@" not in caught.value.message
    assert len(caught.value.message) < 400


def test_a_name_that_nobody_has():
    with pytest.raises(NoLink, match="Could not resolve hostname") as caught:
        connect("ssh://nowhere.invalid")
    assert "kickctl discover" in caught.value.hint


def test_a_machine_without_ssh(monkeypatch, tmp_path):
    (tmp_path / "sh").symlink_to("/bin/sh")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(NoLink, match="ssh") as caught:
        connect("ssh://brick")
    assert "openssh-client" in caught.value.hint


@pytest.mark.parametrize(
    "uri",
    [
        "ssh://",
        "ssh://brick:x",
        "ssh://brick?port=x",
        "ssh://brick?prot=1",
        "ssh://brick/home",
        "ssh://robot:maker@brick",
    ],
)
def test_what_is_no_address(uri):
    with pytest.raises(WrongUse):
        make_link(uri)


def test_a_host_name_is_never_an_option_for_ssh(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(WrongUse):
        connect("ssh://-oProxyCommand=touch%20here")
    assert list(tmp_path.iterdir()) == []


def test_the_command_line_says_it_in_words():
    command = [sys.executable, "-m", "host", "--brick", "ssh://nobody@nowhere.invalid", "status"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 3
    assert "nowhere.invalid" in done.stderr
    assert "Traceback" not in done.stderr
