"""What deploy.sh and ssh:// say when ssh fails can be typed as it stands, and then it works."""

import re
import shlex
import subprocess
import sys

import pytest

from host.client.robot import connect
from host.errors import NoLink
from tests.deploy.brick import ROOT, needs_sshd, write

pytestmark = needs_sshd

CONNECTED = 5  # exit status of --status on a brick without the robot's program


@pytest.fixture
def through(brick, monkeypatch):
    """Have ssh:// find the brick from within the test."""
    monkeypatch.setenv("KICK_SSH_OPTIONS", f"-F {brick.ssh_config}")


def hint(uri="ssh://brick"):
    """What kickctl says is to be done about a link that cannot be opened."""
    with pytest.raises(NoLink) as caught:
        connect(uri)
    return caught.value.hint


def reached(uri="ssh://brick"):
    """Whether ssh gets to the brick, where no robot's program runs."""
    return "ssh works, but the robot's program does not listen there" in hint(uri)


def type_in(checkout, command):
    """Type a command as it stands, and answer yes to a question of ssh."""
    write(checkout.bin / "askpass", "#!/bin/sh\necho yes\n", 0o755)
    asked = {"SSH_ASKPASS": str(checkout.bin / "askpass"), "SSH_ASKPASS_REQUIRE": "force"}
    return subprocess.run(
        ["/bin/sh", "-c", command],
        env=checkout.environment(**asked),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )


def rewrite(brick, old, new):
    """Change the user's settings of ssh."""
    text = brick.ssh_config.read_text(encoding="utf-8")
    assert old in text
    write(brick.ssh_config, text.replace(old, new))


@pytest.mark.parametrize("by", ["deploy.sh", "ssh://"])
@pytest.mark.parametrize("alias", [True, False], ids=["alias", "port"])
def test_a_new_card_and_then_a_brick_never_met(brick, checkout, through, by, alias):
    if not alias:
        rewrite(brick, f"    HostKeyAlias [127.0.0.1]:{brick.port}\n", "")
    other = (brick.folder / "user_key.pub").read_text(encoding="utf-8")
    write(brick.folder / "known_hosts", f"[127.0.0.1]:{brick.port} {other}")

    def advice():
        if by == "ssh://":
            return hint()
        status, output = checkout.deploy("--status")
        assert status == 3
        assert "is it on?" not in output
        return output

    assert type_in(checkout, re.search("type (ssh-keygen .*), then", advice())[1]).returncode == 0
    meet = re.search("type (ssh .*), and say yes", advice())[1]
    type_in(checkout, meet)
    assert checkout.deploy("--status")[0] == CONNECTED
    assert reached()


def test_too_many_keys(brick, checkout, through):
    decoys = [brick.folder / f"decoy{number}" for number in range(3)]
    for decoy in decoys:
        subprocess.run(
            ["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", decoy, "-C", ""], check=True
        )
    lines = "".join(f"    IdentityFile {decoy}\n" for decoy in decoys)
    rewrite(brick, "    IdentityFile", lines + "    IdentityFile")
    brick.configure("MaxAuthTries 2")
    status, output = checkout.deploy("--status")
    assert status == 3
    assert "password maker" not in output
    command, other = [line for line in output.splitlines() if line.startswith("  KICK_SSH_OPTIONS")]
    assert "PubkeyAuthentication=no" in other
    key = str(brick.folder / "user_key")
    done = type_in(checkout, command.replace("KEY", key) + " --status")
    assert done.returncode == CONNECTED, done.stderr
    options = re.search("KICK_SSH_OPTIONS='(.*?KEY)'", hint())[1].replace("KEY", key)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("KICK_SSH_OPTIONS", f"{options} -F {brick.ssh_config}")
        assert reached()


def test_a_brick_that_lets_nobody_in(brick, checkout, through):
    write(brick.folder / "user_key.pub", "")
    status, output = checkout.deploy("--status")
    assert status == 3
    assert "password maker" in output
    copy = f"ssh-copy-id -F {brick.ssh_config} robot@brick"
    assert copy in output
    assert f"{checkout.folder}/deploy.sh robot@brick" in output
    assert copy in hint()
    copy = f"ssh-copy-id -F {brick.ssh_config} -p {brick.port} pi@brick"
    assert copy in hint(f"ssh://pi@brick:{brick.port}")


def test_forwarding_that_the_brick_forbids(brick, through):
    brick.configure("AllowTcpForwarding no")
    assert "tcp://127.0.0.1," in hint()
    assert "tcp://127.0.0.1:77," in hint("ssh://brick?port=77")
    assert "AllowTcpForwarding yes" in hint()
    brick.configure("AllowTcpForwarding yes")
    assert reached()


@pytest.mark.parametrize(
    "setting",
    [
        "RemoteCommand tmux attach",
        "RequestTTY force",
        "PermitLocalCommand yes\n    LocalCommand echo kickctl-token=x=",
        "ExitOnForwardFailure yes\n    LocalForward 1 127.0.0.1:1",
        "LogLevel QUIET",
    ],
)
def test_settings_for_a_login_by_hand_are_no_hindrance(brick, checkout, through, setting):
    rewrite(brick, "    IdentitiesOnly", f"    {setting}\n    IdentitiesOnly")
    status, output = checkout.deploy("--status")
    assert status == CONNECTED, output
    assert "kickctl-token" not in output
    assert reached()


@pytest.mark.parametrize("name", ["nowhere", "a %h 'b' $c", "long" * 40])
def test_any_folder_for_temporary_files(brick, checkout, through, monkeypatch, tmp_path, name):
    folder = tmp_path / name
    if name != "nowhere":
        folder.mkdir()
    monkeypatch.setenv("TMPDIR", str(folder))
    assert checkout.deploy("--status")[0] == CONNECTED
    assert reached()


def test_an_alias_keeps_its_capitals(brick, checkout, through):
    rewrite(brick, "Host brick", "Host EV3-Lab")
    assert checkout.deploy("--status", to="EV3-Lab")[0] == CONNECTED
    assert checkout.deploy("--status", to="ssh://EV3-Lab")[0] == CONNECTED
    assert reached("ssh://EV3-Lab")


def test_options_are_quoted_in_the_same_way_everywhere(brick, checkout, monkeypatch, tmp_path):
    folder = tmp_path / "Ann's settings"
    folder.mkdir()
    config = (folder / "a b").resolve()
    write(config, brick.ssh_config.read_text(encoding="utf-8"))
    options = f"-F {shlex.quote(str(config))} -o 'ServerAliveCountMax 4'"
    monkeypatch.setenv("KICK_SSH_OPTIONS", options)
    assert reached()
    status, output = checkout.deploy("--status", KICK_SSH_OPTIONS=options)
    assert status == CONNECTED, output


def test_the_closing_words_lead_to_a_robot_that_listens_elsewhere(brick, checkout):
    """At one address and any port, deployed from a folder with a space and an apostrophe."""
    checkout.folder = checkout.folder.rename(checkout.folder.with_name("Ann's robot"))
    write(checkout.bin / "make", "#!/bin/sh\n[ $1 = setup ] && pwd\n", 0o755)
    arguments = f"--sysfs {brick.sysfs} --host 127.0.0.2 --port 0"
    path = f"{checkout.bin}:/usr/sbin:/usr/bin:/sbin:/bin"
    status, output = checkout.deploy(KICK_ROBOT_ARGS=arguments, PATH=path)
    assert status == 0, output
    bare = {"PATH": path}
    setup = re.search("no kickctl yet: type (.*)", output)[1]
    done = subprocess.run(
        ["/bin/sh", "-c", setup], env=bare, capture_output=True, text=True, check=False
    )
    assert done.stdout == f"{checkout.folder}\n", done.stderr
    kickctl = checkout.folder / ".venv" / "bin" / "kickctl"
    link = 'cd "$(dirname "$0")"; ' + f"PYTHONPATH={ROOT} exec {sys.executable} -m host"
    write(kickctl, f'#!/bin/sh\n{link} "$@"\n', 0o755)
    (clear,) = [line for line in output.splitlines() if line.endswith(" clear")]
    done = subprocess.run(
        ["/bin/sh", "-c", clear], env=bare, capture_output=True, text=True, check=False
    )
    # Understood as a command of the right robot: its motors are not there.
    assert done.returncode == 5, done.stderr
    assert "left motor (outB): there is none" in done.stderr
    status, output = checkout.deploy("--status")
    assert status == 0, output
