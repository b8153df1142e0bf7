"""`recover` rebuilds what can be read of a log that breaks off, for the strictest readers."""

import threading

import pytest
from mcap.reader import NonSeekingReader, SeekingReader
from mcap.stream_reader import StreamReader

from host.logs.log import Log
from host.logs.log_folder import list_logs
from host.logs.mcap_files import LogError, McapTap
from host.logs.recovery import recover
from tests.unit.logs.test_mcap_files import INFO, bits, running


def read_strictly(path):
    """How many messages each of mcap's readers finds, all checksums compared."""
    with path.open("rb") as file:
        items = list(StreamReader(file, validate_crcs=True).records)
        assert type(items[-1]).__name__ == "Footer"
        file.seek(0)
        indexed = SeekingReader(file, validate_crcs=True)
        counts = [
            indexed.get_summary().statistics.message_count,
            len(list(indexed.iter_messages())),
        ]
        file.seek(0)
        counts.append(len(list(NonSeekingReader(file, validate_crcs=True).iter_messages())))
    return counts


def test_wherever_a_log_breaks_off_it_is_rebuilt(tmp_path):
    log = running(200)
    whole = log.save(tmp_path / "log.mcap").read_bytes()
    for number, share in enumerate((0.3, 0.5, 0.9, 0.999)):
        cut = tmp_path / f"cut{number}.mcap"
        cut.write_bytes(whole[: int(share * len(whole))])
        kept = Log.load(cut)
        result = recover(cut)
        assert result.path == tmp_path / f"cut{number}-recovered.mcap"
        assert not result.was_whole
        back = Log.load(result.path)
        assert back.info == INFO
        assert 0 < len(back) == result.ticks
        assert bits(back) == bits(log)[: len(back)] == bits(kept)
        assert (back.events, back.places) == (kept.events, kept.places)
        assert read_strictly(result.path) == [len(back.records) + len(back.events)] * 3
        assert cut.read_bytes() == whole[: int(share * len(whole))]


def test_the_log_of_a_killed_process_is_rebuilt(tmp_path):
    tap = McapTap(tmp_path / "log.mcap", INFO)
    running(100).play(tap)
    ticks = recover(tap.path).ticks
    tap.close()
    assert ticks > 60
    recovered, original = sorted(list_logs(tmp_path))
    assert (recovered.ticks, recovered.note) == (ticks, "")
    assert original.ticks == 100


def test_nothing_is_overwritten(tmp_path):
    path = running(10).save(tmp_path / "log.mcap")
    first, second = recover(path).path, recover(path).path
    assert [first.name, second.name] == ["log-recovered.mcap", "log-recovered-2.mcap"]
    for out in (path, first):
        with pytest.raises(LogError, match="exists already"):
            recover(path, out)
    assert bits(Log.load(path)) == bits(running(10))
    assert len(list(tmp_path.iterdir())) == 3


def test_programs_that_recover_one_log_at_a_time_have_files_of_their_own(tmp_path):
    path = running(50).save(tmp_path / "log.mcap")
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(path.read_bytes()[:-200])
    barrier, results = threading.Barrier(4), []

    def work():
        barrier.wait()
        results.append(recover(cut))

    workers = [threading.Thread(target=work) for _ in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert len({result.path for result in results}) == 4
    assert {len(Log.load(result.path)) for result in results} == {results[0].ticks}
    assert len(list(tmp_path.iterdir())) == 6


def test_a_link_is_recovered_beside_itself(tmp_path):
    (tmp_path / "logs").mkdir()
    path = running(50).save(tmp_path / "logs" / "log.mcap")
    link = tmp_path / "link.mcap"
    link.symlink_to(path)
    assert recover(link).path == tmp_path / "link-recovered.mcap"
    assert [item.name for item in (tmp_path / "logs").iterdir()] == ["log.mcap"]


def test_what_holds_no_log_cannot_be_rebuilt(tmp_path):
    whole = running(10).save(tmp_path / "log.mcap").read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole[:40])
    with pytest.raises(LogError, match="holds no log"):
        recover(cut)
    assert len(list(tmp_path.iterdir())) == 2


def test_a_log_of_which_nothing_can_be_read_leaves_no_empty_one(tmp_path):
    whole = running(200).save(tmp_path / "log.mcap").read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole[:1000])
    with pytest.raises(LogError, match="no tick and no event") as raised:
        recover(cut)
    assert "kickctl log pull" in raised.value.hint
    assert len(list(tmp_path.iterdir())) == 2
