"""Each row of the fault table once, for what comes of it.

`make faults` tries them often enough for their times to mean something.
"""

from random import Random

import pytest

from tests.faults.rows import ROWS
from tests.faults.tries import Result, attempt, line
from tests.live import impatient
from tests.sysfs.mount import mounted, needs_mount

pytestmark = needs_mount


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    with mounted(tmp_path_factory.mktemp("faults") / "sys", "--seed", "1") as mount, impatient():
        yield mount


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.name)
def test_the_motors_stop_and_the_host_is_told(folder, tmp_path, row):
    if row.lacks():
        pytest.skip(row.lacks())
    result = attempt(row, folder, tmp_path, 1, Random(1))
    assert result.failures == []


@pytest.mark.parametrize(
    ("seconds", "failures", "verdict"),
    [
        ([0.1, 0.2], [], "holds"),
        ([0.1, 0.3], [], "late"),
        ([0.1], ["why"], "fails"),
        ([], [], "late"),
        ([None], [], "late"),
    ],
)
def test_a_row_holds_only_if_every_try_does_and_in_time(seconds, failures, verdict):
    text, holds = line(ROWS[0], Result(seconds, "", failures))
    assert ROWS[0].limit_s == 0.25
    assert text.endswith(f"| {verdict} |")
    assert holds == (verdict == "holds")
