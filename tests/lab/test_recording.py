"""A log that the lab records, on a disk that fails."""

import errno

from host.client.robot import connect
from host.lab.recording import Recording


def test_a_log_that_could_not_be_written_is_not_whole(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said = []
    with connect("sim://?seed=1", observe=True) as robot:
        recording = Recording(robot.info(), lambda message, hint: said.append(message))

    def fill(records):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(recording._file, "take_records", fill)
    recording.take_records([])
    recording.close()
    assert recording.ending() == {"whole": False, "failed": True}
    assert "No space left on device" in said[0]
