"""What goes wrong in a deploy.

The brick keeps, or gets back, a program that runs, and a person is told what to do.
"""

import os
import signal
import socket
import subprocess
import threading
from contextlib import contextmanager, suppress

import pytest

from tests.deploy.brick import needs_sshd, wait_until, write

pytestmark = needs_sshd


@pytest.fixture
def deployed(brick, checkout):
    """A brick with a release that runs, and a checkout with another."""
    status, output = checkout.deploy()
    assert status == 0, output
    checkout.change()
    return brick


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
def test_an_empty_battery_is_refused(brick, checkout, technology, microvolts, status):
    battery = brick.sysfs / "power_supply" / "lego-ev3-battery"
    write(battery / "technology", technology + "\n")
    if microvolts is None:
        (battery / "voltage_now").unlink()
    else:
        write(battery / "voltage_now", f"{microvolts}\n")
    found, output = checkout.deploy()
    assert found == status, output
    assert ("charge it" in output) == (status == 4)
    assert (brick.runs() is None) == (status == 4)


@pytest.mark.parametrize(
    ("module", "text", "words"),
    [
        ("__main__", "\nraise SystemExit('the dog ate it')\n", "the dog ate it"),
        ("program", "\nimport nothing_of_that_name\n", "nothing_of_that_name"),
        ("server", "\nServer.serve = lambda self, timeout_s: None\n", "not well"),
        (
            "loop",
            "\nLoop.tick = lambda self: setattr(self, 'deadline', self.deadline + 0.01)\n",
            "it does not tick",
        ),
    ],
)
def test_a_release_that_is_not_well_is_rolled_back(brick, checkout, module, text, words):
    checkout.deploy()
    good = brick.release()
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
    assert (brick.runs(), brick.release()) == (good, good)
    assert checkout.deploy("--status")[0] == 0


def test_a_first_release_that_dies_leaves_nothing_that_runs(brick, checkout):
    params = checkout.folder / "robot" / "params.py"
    sound = params.read_bytes()
    checkout.change("params", "\nraise RuntimeError('no')\n")
    status, output = checkout.deploy()
    assert status == 5
    assert "RuntimeError: no" in output
    assert "there was none before it" in output
    assert (brick.runs(), brick.release()) == (None, None)
    params.write_bytes(sound)
    status, output = checkout.deploy()
    assert status == 0, output


def test_arguments_that_kill_the_program_are_taken_back(deployed, checkout):
    release = deployed.release()
    status, output = checkout.deploy(KICK_ROBOT_ARGS="--left")
    assert status == 1
    assert "expected one argument" in output
    assert deployed.runs() == release
    assert "--sysfs" in (deployed.kickctl / "arguments").read_text(encoding="utf-8")


def test_arguments_that_were_put_back_are_told(brick, checkout):
    checkout.deploy()
    status, output = checkout.deploy(KICK_ROBOT_ARGS="--left")
    assert status == 1
    last = output[output.index(f"{brick.release()} runs again") :]
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


def test_arguments_are_never_a_command_for_the_bricks_shell(deployed, checkout):
    arguments = """--it's "$(touch here)" `touch there`; touch everywhere"""
    status, output = checkout.deploy(KICK_ROBOT_ARGS=arguments)
    assert status == 1
    assert f"instead of '{arguments}'" in output
    assert [path for path in deployed.home.rglob("*") if path.name.endswith("here")] == []


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


def test_a_release_damaged_on_the_card_is_sent_again(brick, checkout):
    checkout.deploy()
    loop = brick.kickctl / "current" / "robot" / "loop.py"
    whole = loop.read_bytes()
    loop.write_bytes(whole[:1000])
    status, output = checkout.deploy()
    assert status == 0, output
    assert loop.read_bytes() == whole


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


def test_a_process_that_only_has_the_old_number_is_left_alone(deployed, checkout):
    deployed.stop_program()
    with subprocess.Popen(["sleep", "1000"]) as stranger:
        write(deployed.kickctl / "robot.pid", f"{stranger.pid}\n")
        assert checkout.deploy()[0] == 0
        assert stranger.poll() is None
        stranger.kill()
    assert deployed.runs() == deployed.release()


def test_a_program_that_has_yet_to_write_its_number_is_waited_for(brick, checkout):
    """Its shell creates robot.pid and then writes to it: deploy may look in between."""
    brick.replace("setsid", ': >~/kickctl/robot.pid; sleep 1; exec /usr/bin/setsid "$@"')
    status, output = checkout.deploy()
    assert status == 0, output
    assert brick.runs() == brick.release()


def test_two_deploys_at_once_do_not_get_into_each_others_way(deployed, checkout):
    with checkout.deploying() as one, checkout.deploying() as other:
        outputs = [process.communicate(timeout=100)[0] for process in (one, other)]
    assert 0 in (one.returncode, other.returncode), outputs
    assert deployed.runs() == deployed.release()
    status, output = checkout.deploy()
    assert status == 0, output


@contextmanager
def cut_after(brick, to_brick):
    """Everything between ssh and the brick goes through here, until so many bytes were sent to it.

    Then the line is dead.
    """
    listener = socket.create_server(("127.0.0.1", 0))
    links = []

    def carry(source, target, budget):
        with suppress(OSError):
            while budget > 0 and (data := source.recv(min(4096, budget))):
                target.sendall(data)
                budget -= len(data)
            cut()

    def cut():
        for link in links:
            with suppress(OSError):
                link.shutdown(socket.SHUT_RDWR)

    def serve():
        with suppress(OSError):
            near = listener.accept()[0]
            listener.close()
            far = socket.create_connection(("127.0.0.1", brick.port))
            links.extend((near, far))
            threading.Thread(target=carry, args=(far, near, 10**9), daemon=True).start()
            carry(near, far, to_brick)

    server = threading.Thread(target=serve, daemon=True)
    server.start()
    brick.reach_through(listener.getsockname()[1])
    try:
        yield cut
    finally:
        cut()
        listener.close()
        server.join(10)
        for link in links:
            link.close()
        brick.reach_through(brick.port)


@pytest.mark.parametrize("sent", [100, 12000, 30000])
def test_a_connection_cut_in_the_upload_leaves_the_old_release(deployed, checkout, sent):
    release, pid = deployed.release(), deployed.pid()
    with cut_after(deployed, sent):
        status, output = checkout.deploy()
    assert status == 3, output
    assert "no connection" in output
    assert (deployed.pid(), deployed.release()) == (pid, release)
    status, output = checkout.deploy()
    assert status == 0, output
    assert deployed.runs() == deployed.release() != release
    assert not [name for name in deployed.releases() if name.startswith(".")]


def test_a_connection_cut_in_the_change_over_does_not_stop_it(deployed, checkout):
    """The brick goes on without anybody who looks, and has a program that runs in the end."""
    release = deployed.release()
    with cut_after(deployed, 10**9) as cut, checkout.deploying() as process:
        wait_until(lambda: deployed.pid() is None)
        cut()
        output = process.communicate(timeout=60)[0]
        assert process.returncode == 3, output
    wait_until(lambda: deployed.release("previous") == release)
    assert deployed.runs() == deployed.release() != release
    assert checkout.deploy("--status")[0] == 0


def test_a_connection_cut_in_the_change_over_to_a_bad_release_rolls_back(deployed, checkout):
    release = deployed.release()
    checkout.change("params", "\nimport time\ntime.sleep(1)\nraise RuntimeError('no')\n")
    with cut_after(deployed, 10**9) as cut, checkout.deploying() as process:
        wait_until(lambda: deployed.runs() not in (None, release))
        cut()
        process.communicate(timeout=60)
    wait_until(
        lambda: deployed.runs() == deployed.release() == release and "READY" in deployed.log()
    )


def test_no_brick_at_the_address_is_told_in_words(checkout, brick):
    brick.reach_through(1)
    status, output = checkout.deploy()
    assert status == 3
    assert "Connection refused" in output
    assert "address on its screen" in output


def test_a_brick_with_a_new_card_is_told_from_one_that_is_off(brick, checkout):
    write(
        brick.folder / "known_hosts",
        f"[127.0.0.1]:{brick.port} {(brick.folder / 'user_key.pub').read_text(encoding='utf-8')}",
    )
    status, output = checkout.deploy()
    assert status == 3
    assert "IDENTIFICATION HAS CHANGED" in output
    assert "ssh-keygen -R brick" in output
    assert "is it on?" not in output


def test_a_brick_never_met_is_told(brick, checkout):
    write(brick.folder / "known_hosts", "")
    status, output = checkout.deploy()
    assert status == 3
    assert "ssh brick, and say yes" in output


def test_a_brick_that_lets_nobody_in_is_told_with_the_password(brick, checkout):
    write(brick.folder / "user_key.pub", "")
    status, output = checkout.deploy()
    assert status == 3
    assert "Permission denied" in output
    assert "maker" in output
    assert "ssh-copy-id robot@brick" in output


def test_a_name_that_nobody_has_is_told_with_how_to_find_another(checkout):
    status, output = checkout.deploy(to="robot@nowhere.invalid")
    assert status == 3
    assert "the network knows no nowhere.invalid: kickctl discover" in output
