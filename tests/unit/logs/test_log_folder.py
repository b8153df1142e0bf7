"""The list of logs says when each began."""

import os
from datetime import UTC, datetime

import pytest

from host.logs.log import Log
from host.logs.log_folder import list_logs
from tests.fakes import Rig

ZERO_S = 1795360500.25
CONNECTED = "2026-11-22T14:30:12+00:00"


def part_of_a_conversation(**info):
    rig = Rig()
    rig.loop.start()
    rig.run(100)
    log = Log({"started_utc": CONNECTED, **info})
    log.take_records(rig.log().records[50:])
    return log


@pytest.mark.parametrize("cut", [0, 100], ids=["whole", "breaks off"])
def test_a_log_began_with_its_first_tick_not_when_its_host_connected(tmp_path, cut):
    def listed(log, written_s):
        path = tmp_path / f"{written_s}.mcap"
        whole = log.save(path).read_bytes()
        path.write_bytes(whole[: len(whole) - cut])
        os.utime(path, (written_s, written_s))
        (row,) = list_logs(tmp_path)
        path.unlink()
        return row.started_utc

    log = part_of_a_conversation(clock_zero_s=ZERO_S)
    exact = datetime.fromtimestamp(ZERO_S + log.records[0].t_s, UTC)
    began = datetime.fromisoformat(listed(log, ZERO_S + 1000.0))
    assert abs((began - exact).total_seconds()) < 1e-3
    # A simulated robot's time may be ahead of the computer's: its log would begin after its end.
    assert listed(log, ZERO_S - 1000.0) == CONNECTED
    assert listed(part_of_a_conversation(), ZERO_S + 1000.0) == CONNECTED
    empty = Log({"started_utc": CONNECTED, "clock_zero_s": ZERO_S})
    assert listed(empty, ZERO_S + 1000.0) == CONNECTED
