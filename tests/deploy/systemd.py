"""As much of systemd as the service needs.

`systemd.py start` and `systemd.py stop`, in place of systemctl.

It does what the unit file says of ExecStart, ExecStopPost, WatchdogSec, Restart and RestartSec.
"""

import configparser
import contextlib
import os
import shlex
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

SYSTEM = Path(os.environ["KICK_ETC"]) / "systemd" / "system"
UNIT = SYSTEM / "kickctl.service"
PID = SYSTEM / "manager.pid"
STEP_S = 0.05


def supervise(service):
    """Run the service until it ends well or is stopped."""
    stopped = []
    signal.signal(signal.SIGTERM, lambda number, frame: stopped.append(number))
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as link:
        # Linux gives it a name outside of all folders: the path of a test may be too long for one.
        link.bind("")
        address = "@" + link.getsockname()[1:].decode("ascii")
        link.settimeout(STEP_S)
        while True:
            status = run_once(service, link, address, stopped)
            subprocess.run(words(service["ExecStopPost"]), check=False)
            if stopped or status == 0:
                return
            time.sleep(float(service["RestartSec"]))


def run_once(service, link, address, stopped):
    """The main process's exit status."""
    patience = float(service["WatchdogSec"])
    environment = {
        **os.environ,
        "NOTIFY_SOCKET": address,
        "WATCHDOG_USEC": str(int(1e6 * patience)),
    }
    process = subprocess.Popen(words(service["ExecStart"]), env=environment)
    due = None
    while process.poll() is None:
        with contextlib.suppress(TimeoutError):
            said = link.recv(100).decode()
            with (SYSTEM / "notified").open("a", encoding="ascii") as log:
                log.write(f"{process.pid} {said}\n")
            due = time.monotonic() + patience
        if due is not None and time.monotonic() > due:
            process.send_signal(signal.SIGABRT)
            process.send_signal(signal.SIGCONT)
            due = None
        if stopped:
            process.terminate()
    return process.returncode


def words(command):
    """A unit file's command line as a list."""
    return [word.replace("$$", "$") for word in shlex.split(command.removeprefix("+"))]


def main():
    if sys.argv[1] == "start":
        parser = configparser.RawConfigParser(strict=False)
        parser.optionxform = str
        parser.read(UNIT)
        if os.fork() == 0:
            os.setsid()
            os.closerange(0, 20)
            os.open(os.devnull, os.O_RDWR)
            os.dup2(0, 1)
            os.dup2(0, 2)
            PID.write_text(str(os.getpid()), encoding="ascii")
            supervise(parser["Service"])
            PID.unlink()
            os._exit(0)
    elif sys.argv[1] == "stop" and PID.exists():
        manager = int(PID.read_text(encoding="ascii"))
        os.kill(manager, signal.SIGTERM)
        while PID.exists():
            time.sleep(STEP_S)


main()
