"""kickctl deploy."""

from __future__ import annotations

import argparse
import os
import sys

from host.commands._parser import RawHelp
from host.errors import WrongUse
from host.link import robots_file
from host.link.logins import parse_login
from host.util.installation import DEPLOY_SCRIPT, kickctl_command

HELP = "bring the robot's program to a brick over ssh, and start it there"
USES = ("brick", "token")

DEFAULT_LOGIN = "robot@ev3dev.local"
# The options of deploy.sh, which does the work.
OPTIONS = {
    "service": "have the program start with the brick from now on (asks for the brick's password)",
    "no-service": "undo that: from now on the program starts only when it is deployed",
    "rollback": "go back to the release before this one",
    "status": "show which release is on the brick, and how it is",
    "logs": "show what the robot's program printed",
    "dry-run": "show what would be done; connect to nothing",
}
_DETAILS = """\
Without an option: check the brick, copy the robot's program and the token that lets this machine
command it, stop the program that runs and its motors, start the new one and check that it is well.
If it is not, the one before it runs again.

The wheels turn as soon as the program is ready, unless it runs as a service: hold the robot up, or
start the program with --idle.

BRICK is USER@HOST, HOST (also a name of ~/.ssh/config), or ssh://USER@HOST:PORT, where PORT is the
port of ssh. An IPv6 address before a port stands in brackets.

Environment:
  KICK_ROBOT_ARGS    arguments of the robot's program, from this deploy on:
                     '--idle --left outA --right outD --set polarity_left=-1'
  KICK_TOKEN         the token's file (default ~/.config/kickctl/tokens/NAME)
  KICK_SSH_OPTIONS   options for ssh, for example '-p 2222 -i "my key"', quoted as for a shell

Exit status: 0 done, and the program is well; 1 not done, and the brick is as it was; 2 wrong use;
3 no connection; 4 the brick is not fit (Python, space, battery); 5 no robot's program is well on
the brick now."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of deploy.sh, and the brick."""
    parser.formatter_class = RawHelp
    parser.epilog = _DETAILS
    parser.add_argument(
        "login", nargs="?", metavar="BRICK", help="the brick (default robot@ev3dev.local)"
    )
    for name, text in OPTIONS.items():
        parser.add_argument(
            f"--{name}", dest="given", action="append_const", const=f"--{name}", help=text
        )

    parser.add_argument(
        "--as",
        dest="robot_name",
        metavar="NAME",
        help="the robot's name here from now on, for --brick NAME (default: the name that it has,"
        " or that of its machine)",
    )


def run(options: argparse.Namespace) -> int:
    """Become deploy.sh, with its output, its questions at the terminal and its exit status."""
    if options.json:
        raise WrongUse("deploy does not answer in JSON", "leave --json out")
    if options.brick is not None:
        raise WrongUse(
            "deploy reaches the brick by ssh only, not through --brick",
            "name the brick's user and address: kickctl deploy robot@ev3dev.local",
        )
    environment = {**os.environ, "KICKCTL": kickctl_command()}
    # Checked here by its own rules, and by deploy.sh by the same in shell.
    login = [] if options.login is None else [str(parse_login(options.login))]
    environment["KICK_AS"], own = _known(options.robot_name, login)
    token = options.token or os.environ.get("KICK_TOKEN") or own
    if token:
        environment["KICK_TOKEN"] = token
    sys.stdout.flush()
    os.execvpe(  # noqa: S606 - ssh has to find the terminal as it is
        "sh", ["sh", str(DEPLOY_SCRIPT), *(options.given or []), *login], environment
    )


def _known(name: str | None, login: list[str]) -> tuple[str, str | None]:
    """The name of the brick's robot, and its own token file if it has one.

    Raises:
        WrongUse: A robot cannot be named so.
    """
    address = f"ssh://{login[0] if login else DEFAULT_LOGIN}"
    if name is None:
        for robot in robots_file.read().values():
            # Its program may listen at another port than the usual one.
            if robot.address.split("?")[0] == address:
                return robot.name, robot.token
        return robots_file.free_name(parse_login(address).host, ()), None
    known = robots_file.read().get(robots_file.need_name(name))
    return name, None if known is None else known.token
