"""kickctl deploy becomes deploy.sh, with its arguments, terminal, output and exit status."""

import os
import pty
import re
import subprocess
import sys

import pytest

from host.commands import deploy
from tests.package.conftest import ROOT

# An ssh that asks for a password at the terminal, as the real one does.
ASKING_SSH = """\
#!/bin/sh
printf 'password: ' >/dev/tty
read answer </dev/tty
echo "called with $*, and the answer $answer"
exit 4
"""


def write_ssh(folder, script):
    path = folder / "ssh"
    path.write_text(script, encoding="utf-8")
    path.chmod(0o755)


def run(folder, *arguments, **environment):
    """Run `kickctl deploy` with the ssh of a folder: (status, standard output, standard error)."""
    done = subprocess.run(
        [sys.executable, "-m", "host", *arguments],
        env={**os.environ, "PATH": f"{folder}:/usr/bin:/bin", "PYTHONPATH": ROOT, **environment},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, done.stdout, done.stderr


def test_the_verb_has_the_options_of_the_script():
    usage = (ROOT / "deploy.sh").read_text(encoding="utf-8").partition("usage() {")[2]
    options = re.findall(r"^  --([a-z-]+) ", usage.partition("\n}\n")[0], re.MULTILINE)
    assert options == [*deploy.OPTIONS, "help"]


def test_arguments_output_and_exit_status_pass_through(tmp_path):
    write_ssh(tmp_path, '#!/bin/sh\necho "called: $*"\nexit 5\n')
    status, out, _ = run(tmp_path, "deploy", "robot@there", "--status")
    assert status == 5
    assert "connecting to robot@there" in out
    assert "-- robot@there sh -s status" in out


def test_a_brick_out_of_reach_is_the_scripts_own_exit_status(tmp_path):
    write_ssh(tmp_path, "#!/bin/sh\nexit 255\n")
    status, _, err = run(tmp_path, "deploy")
    assert status == 3
    assert "no connection to robot@ev3dev.local" in err


def test_a_password_can_be_typed_at_the_terminal(tmp_path):
    write_ssh(tmp_path, ASKING_SSH)
    pid, terminal = pty.fork()
    if pid == 0:
        environment = {**os.environ, "PATH": f"{tmp_path}:/usr/bin:/bin", "PYTHONPATH": str(ROOT)}
        command = [sys.executable, "-m", "host", "deploy", "--status", "robot@there"]
        os.execvpe(command[0], command, environment)  # noqa: S606 - the child of a fork
    shown = b""
    while b"password: " not in shown:
        shown += os.read(terminal, 1000)
    os.write(terminal, b"maker\n")
    with pytest.raises(OSError, match="Input/output error"):  # the end of a terminal's output
        while True:
            shown += os.read(terminal, 1000)
    os.close(terminal)
    assert os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == 4
    assert b"the answer maker" in shown


def test_hints_name_the_verb_and_not_the_script(tmp_path):
    write_ssh(tmp_path, "#!/bin/sh\necho 'Connection refused' >&2\nexit 1\n")
    status, out, _ = run(tmp_path, "deploy", "--help")
    assert status == 0
    assert "--rollback" in out
    status, _, err = run(tmp_path, "deploy", "--status", "--logs")
    assert status == 2
    assert err.startswith("deploy: --status and --logs at once")


def test_the_token_file_is_the_one_that_the_options_name(tmp_path):
    token = tmp_path / "mine"
    token.write_text("00" * 32 + "\n", encoding="ascii")
    out = run(tmp_path, "--token", str(token), "deploy", "--dry-run")[1]
    assert f"copy the token {token}" in out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--brick", "tcp://there", "deploy"), "robot@ev3dev.local"),
        (("deploy", "--json"), "--json"),
    ],
)
def test_what_the_script_does_not_know_is_refused(tmp_path, arguments, words):
    write_ssh(tmp_path, "#!/bin/sh\ntouch called\n")
    status, _, err = run(tmp_path, *arguments)
    assert status == 2
    assert words in err
    assert not (tmp_path / "called").exists()
