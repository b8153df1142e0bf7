"""How long a tick's reads and writes take, on files in memory.

Through robot.ev3, through python-ev3dev2's properties, and by bare calls.
"""

import os
import tempfile
import time
from itertools import chain
from math import inf
from pathlib import Path

from ev3dev2.motor import LargeMotor

from tests.bench_arm.ways import PORTS, make_tree, our_motors

IN_MEMORY = Path("/dev/shm")  # noqa: S108 - no file of a fixed name is made there
# Short rounds by turns: each way gets its share of the machine's quiet moments.
DUTIES = [7 * tick % 171 - 85 for tick in range(250)]
ROUNDS = 400
LIBRARY_AT_LEAST, BARE_AT_MOST = 2.5, 1.3


def reads_and_writes() -> None:
    """Two angles read and two duty cycles written, as ratios of times."""
    with tempfile.TemporaryDirectory(dir=IN_MEMORY if IN_MEMORY.is_dir() else None) as root:
        make_tree(root)
        ours, library, bare = _fastest(_through_robot(root), _through_library(root), _bare(root))
    print(
        f"a tick's two reads and two writes: {1e6 * ours:.2f} us;"
        f" {_verdict(library / ours, LIBRARY_AT_LEAST, -1)} times faster than through"
        f" python-ev3dev2's properties, {_verdict(ours / bare, BARE_AT_MOST, 1)} times the bare"
        f" calls (which are {library / bare:.2f} times faster than the properties)",
        flush=True,
    )


def _verdict(ratio, bound, sign):
    """The ratio, and whether it is within its bound.

    An upper one if sign is 1, a lower one if it is -1.
    """
    word = "PASS" if sign * ratio <= sign * bound else "FAIL"
    return f"{ratio:.2f} ({word}: at {'most' if sign > 0 else 'least'} {bound})"


def _fastest(*ways):
    """The shortest time (s) of a tick in each way.

    Whatever else the machine did only ever adds to it.
    """
    times = [inf] * len(ways)
    for _ in range(ROUNDS):
        for index, way in enumerate(ways):
            start_s = time.perf_counter()
            way()
            times[index] = min(times[index], time.perf_counter() - start_s)
    return [elapsed / len(DUTIES) for elapsed in times]


def _through_robot(root):
    left, right = our_motors(root)

    def way():
        for duty in DUTIES:
            left.angle_rad()
            right.angle_rad()
            left.write_duty(duty)
            right.write_duty(duty)

    return way


def _through_library(root):
    # our_motors has told the library where the tree is.
    left, right = (LargeMotor(port) for port in PORTS)

    def way():
        for duty in DUTIES:
            left.position  # noqa: B018 - reading it is the point
            right.position  # noqa: B018
            left.duty_cycle_sp = duty
            right.duty_cycle_sp = duty

    return way


def _bare(root):
    motors = [Path(root, "tacho-motor", f"motor{number}") for number in range(len(PORTS))]
    files = chain.from_iterable(
        ((motor / "position", os.O_RDONLY), (motor / "duty_cycle_sp", os.O_WRONLY))
        for motor in motors
    )
    left_position, left_duty, right_position, right_duty = (
        os.open(path, mode) for path, mode in files
    )

    def way():
        for duty in DUTIES:
            int(os.pread(left_position, 16, 0))
            int(os.pread(right_position, 16, 0))
            os.pwrite(left_duty, b"%d" % duty, 0)
            os.pwrite(right_duty, b"%d" % duty, 0)

    return way


if __name__ == "__main__":
    reads_and_writes()
