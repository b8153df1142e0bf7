"""docs/protocol-client.md runs as written, and PROTOCOL.md names all that the robot understands."""

import ast
import os
import re
import select
import shlex
import subprocess
import sys
from pathlib import Path

from kickctl import connect
from robot import commands, kick_requests, kicks, record, wire
from tests.api.test_own_motors_page import free_port
from tests.lint.sources import ROOT

PATIENCE_S = 100.0
PAGE = (ROOT / "docs" / "protocol-client.md").read_text(encoding="utf-8")
PROTOCOL = (ROOT / "robot" / "PROTOCOL.md").read_text(encoding="utf-8")
(CLIENT,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
(TYPED,) = re.findall(r"```sh\n(.*?)```", PAGE, re.DOTALL)


def test_a_client_that_needs_nothing_of_ours_kicks_and_stops_the_robot(tmp_path):
    Path("client.py").write_text(CLIENT, encoding="utf-8")
    token = tmp_path / ".config" / "kickctl" / "token"
    port = free_port()
    start, kick = (shlex.split(line) for line in TYPED.replace("5431", port).splitlines())
    assert (start[0], start[-1], kick[0], kick[-1]) == (
        "python",
        "&",
        "python",
        "~/.config/kickctl/token",
    )
    environment = {**os.environ, "HOME": str(tmp_path)}
    for name in ("KICK_TOKEN", "XDG_CONFIG_HOME"):
        environment.pop(name, None)
    robot_command = [sys.executable, *start[1:-1], "--seed", "3"]
    with subprocess.Popen(
        robot_command, env=environment, cwd=ROOT, stdout=subprocess.PIPE, text=True
    ) as robot:
        try:
            assert select.select([robot.stdout], (), (), PATIENCE_S)[0]
            assert robot.stdout.readline() == f"READY tcp://127.0.0.1:{port}\n"
            # -I: neither our packages nor what is installed beside them.
            done = subprocess.run(
                [sys.executable, "-I", "-S", *kick[1:-1], token],
                env=environment,
                capture_output=True,
                text=True,
                timeout=PATIENCE_S,
                check=False,
            )
        finally:
            robot.terminate()
            robot.wait(PATIENCE_S)
    assert (done.returncode, done.stderr) == (0, "")
    before, _, after, stop = done.stdout.splitlines()
    turned = [float(line.split()[-5]) for line in (before, after)]
    assert turned[0] * turned[1] < -1.0
    assert re.fullmatch(r"stopped from tick \d+ on: 'my client' stopped it", stop)


def test_the_client_is_short_and_of_the_standard_library():
    assert len([line for line in CLIENT.splitlines() if line]) <= 53
    imports = [node for node in ast.walk(ast.parse(CLIENT)) if isinstance(node, ast.Import)]
    assert {alias.name for node in imports for alias in node.names} <= sys.stdlib_module_names


def rows(heading):
    """The first cells, without marks, of the table that begins with this line."""
    table = PROTOCOL.partition(heading)[2].partition("\n\n")[0]
    return [line.split(" | ")[0].strip("| `") for line in table.splitlines()[2:]]


def test_the_page_lists_all_fields_of_a_kick_and_their_choices():
    heading = "| field | mode | type | unit | what |"
    assert tuple(rows(heading)) == kick_requests.FIELDS
    table = PROTOCOL.partition(heading)[2].partition("\n\n")[0]
    for word in (*kicks.MODES, *kicks.WHEELS, *kicks.PULSED, kicks.RECTANGULAR, kicks.SMOOTH):
        assert f'"{word}"' in table


def test_the_page_lists_all_that_the_robots_hello_says():
    answer = PROTOCOL.partition("**2.**")[2].partition("**3.**")[0]
    with connect("sim://") as robot:
        assert [name for name in robot.hello if f"`{name}`" not in answer] == []


def test_the_page_lists_all_requests_and_frames():
    listed = [name for row in rows("| `do` | arguments | result |") for name in row.split("`, `")]
    sealed = PROTOCOL.partition("must come as COMMAND")[2]
    table = sealed.partition("| `do` | arguments | result |")[2].partition("\n\n")[0]
    for line in table.splitlines()[2:]:
        listed += line.split(" | ")[0].strip("| `").split("`, `")
    assert set(listed) == set(commands.TABLE)
    assert rows("| type | name | from | payload |") == [str(kind) for kind in wire.TYPES]
    for key in record.describe()[0]:
        assert f"`{key}`" in PROTOCOL.partition("A record holds")[2]


def test_the_page_has_every_field_of_a_kick_in_an_event():
    table = PROTOCOL.partition("The `kick` of an event and of a snapshot says all")[2]
    rows = re.findall(r"^\| (`.*?) \|", table, re.MULTILINE)
    assert set(re.findall(r"`(\w+)`", " ".join(rows))) == set(kicks.Kick.__slots__)
