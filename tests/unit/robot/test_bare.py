"""A start of the robot's program imports little: each module takes a brick 10 to 500 ms."""

import subprocess
import sys

from robot import wire

HEAVY = (
    "argparse bisect ctypes datetime glob hashlib hmac logging random runpy selectors signal socket"
    " termios threading traceback"
)
PROGRAM = """
import sys
before = set(sys.modules)
import robot.__main__, robot.ev3
print(*(name for name in sys.argv[1].split() if name in set(sys.modules) - before))
"""


def test_what_has_a_part_in_c_is_imported_without_the_part_in_python():
    root = wire.__file__.rpartition("robot")[0]
    found = subprocess.check_output([sys.executable, "-c", PROGRAM, HEAVY], cwd=root)
    expected = [] if sys.version_info < (3, 12) else [b"hashlib"]  # since 3.12 there is no _sha256
    assert found.split() == expected
