"""After a broken or damaged release, or wrong arguments, the release before runs again."""

import pytest

from tests.deploy.brick import needs_sshd, write

pytestmark = needs_sshd


@pytest.mark.parametrize(
    ("module", "text", "words"),
    [
        ("__main__", "\nraise SystemExit('the dog ate it')\n", "the dog ate it"),
        ("program", "\nimport nothing_of_that_name\n", "nothing_of_that_name"),
        ("server", "\nServer.serve = lambda self, timeout_s: time.sleep(timeout_s)\n", "it hangs"),
        (
            "loop",
            "\nLoop.tick = lambda self: setattr(self, 'deadline', self.deadline + 0.01)\n",
            "it does not tick",
        ),
    ],
)
def test_a_release_that_is_not_well_is_rolled_back(running, checkout, module, text, words):
    good = running.release()
    # At its end, where the program begins to run, it is too late for a change.
    main = checkout.folder / "robot" / "__main__.py"
    begin = main.read_text(encoding="utf-8").partition('if __name__ == "__main__":')
    main.write_text(begin[0], encoding="utf-8")
    checkout.change(module, text)
    checkout.change("__main__", "".join(begin[1:]))
    health = checkout.folder / "robot" / "health.py"
    health.write_text(
        health.read_text(encoding="utf-8").replace("PATIENCE_S = 20.0", "PATIENCE_S = 2.0"),
        encoding="utf-8",
    )
    status, output = checkout.deploy()
    assert status == 1, output
    assert words in output
    assert f"{good} runs again" in output
    assert (running.runs(), running.release()) == (good, good)
    assert checkout.deploy("--status")[0] == 0


def test_a_first_release_that_dies_leaves_nothing_that_runs(brick, checkout):
    params = checkout.folder / "robot" / "params.py"
    sound = params.read_bytes()
    checkout.change("params", "\nraise RuntimeError('no')\n")
    status, output = checkout.deploy()
    assert status == 5
    assert "RuntimeError: no" in output
    assert "there was none before it; the brick sees no motor\n" in output
    assert (brick.runs(), brick.release()) == (None, None)
    params.write_bytes(sound)
    status, output = checkout.deploy()
    assert status == 0, output


@pytest.mark.parametrize(
    ("state", "words"),
    [
        ("", "the motors are off"),
        ("running stalled", "motors may be on: motor0 reads 'running stalled'. Pull their cables"),
        (None, "motors may be on: motor0 reads 'no state'. Pull their cables"),
    ],
)
def test_the_motors_are_called_off_only_if_the_kernel_says_so(brick, checkout, state, words):
    motor = brick.sysfs / "tacho-motor" / "motor0"
    write(motor / "command", "")
    if state is not None:
        write(motor / "state", state + "\n" if state else "")
    checkout.change("params", "\nraise RuntimeError('no')\n")
    status, output = checkout.deploy()
    assert status == 5
    assert f"there was none before it; {words}" in output
    assert (motor / "command").read_text(encoding="ascii") == "reset\n"


def test_arguments_that_kill_the_program_are_taken_back(deployed, checkout):
    release = deployed.release()
    status, output = checkout.deploy(KICK_ROBOT_ARGS="--left")
    assert status == 1
    assert "--left needs a value" in output
    assert deployed.runs() == release
    assert "--sysfs" in (deployed.kickctl / "arguments").read_text(encoding="utf-8")


def test_arguments_that_were_put_back_are_told(running, checkout):
    status, output = checkout.deploy(KICK_ROBOT_ARGS="--left")
    assert status == 1
    last = output[output.index(f"{running.release()} runs again") :]
    assert "arguments of before ('--sysfs" in last
    assert "instead of '--left'" in last


def test_arguments_of_a_deploy_that_never_changed_over_are_of_no_use_to_the_next(
    deployed, checkout
):
    """The arguments arrive, and then somebody else holds the lock, or the line is cut.

    Later comes --rollback, with none.
    """
    checkout.deploy()
    arguments = (deployed.kickctl / "arguments").read_text(encoding="utf-8")
    release = deployed.release()
    deployed.replace("flock", "exit 1")
    status, output = checkout.deploy(KICK_ROBOT_ARGS="--left outA --never")
    assert (status, "somebody else" in output) == (1, True)
    (deployed.bin / "flock").unlink()
    assert checkout.deploy("--rollback")[0] == 0
    assert deployed.runs() != release
    assert (deployed.kickctl / "arguments").read_text(encoding="utf-8") == arguments


def test_arguments_are_never_a_command_for_the_bricks_shell(running, checkout):
    arguments = """--it's "$(touch here)" `touch there`; touch everywhere"""
    status, output = checkout.deploy(KICK_ROBOT_ARGS=arguments)
    assert status == 1
    assert f"instead of '{arguments}'" in output
    assert [path for path in running.home.rglob("*") if path.name.endswith("here")] == []


def test_a_release_that_the_bricks_python_cannot_read_is_never_started(deployed, checkout):
    release, pid = deployed.release(), deployed.pid()
    checkout.change("kicks", "\ndef broken(:\n")
    status, output = checkout.deploy()
    assert status == 1
    assert "cannot read this release" in output
    assert deployed.pid() == pid
    assert deployed.release() == release


@pytest.mark.parametrize(
    "tar",
    [
        '/bin/tar "$@" | head -c 9000',
        "true",
        # Whole for tar, but one file is another one.
        'cp -r . ../elsewhere; cd ../elsewhere; echo "#" >>robot/loop.py; /bin/tar "$@"',
    ],
    ids=["cut short", "empty", "altered"],
)
def test_a_broken_upload_is_noticed(deployed, checkout, tar):
    release, pid = deployed.release(), deployed.pid()
    write(checkout.bin / "tar", f"#!/bin/sh\n{tar}\n", 0o755)
    status, output = checkout.deploy()
    assert status == 1, output
    assert "not arrive whole" in output or "damaged" in output
    assert deployed.pid() == pid
    assert (deployed.runs(), deployed.release()) == (release, release)
    assert not [name for name in deployed.releases() if name.startswith(".")]
    (checkout.bin / "tar").unlink()
    status, output = checkout.deploy()
    assert status == 0, output
    assert deployed.release() != release
    assert not [name for name in deployed.releases() if name.startswith(".")]


def test_a_release_damaged_on_the_card_is_sent_again(running, checkout):
    loop = running.kickctl / "current" / "robot" / "loop.py"
    whole = loop.read_bytes()
    loop.write_bytes(whole[:1000])
    status, output = checkout.deploy()
    assert status == 0, output
    assert loop.read_bytes() == whole
