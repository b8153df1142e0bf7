"""What a run keeps, cell by cell, in any order, if anything interrupts it."""

import csv
from contextlib import closing

import pytest

from host.errors import WrongUse
from host.runs.contract import Part
from host.runs.folder import Study
from host.util.whole_files import whole_file

SETTINGS = {"experiment": "toy", "seed": 1, "options": {"trials": 3}}
CELLS = [{"ticks": ticks, "mode": "phase"} for ticks in range(3)]


def keep(study, *numbers):
    for number in numbers:
        study.keep(
            CELLS[number],
            [{"value": 0.1 * number, "none": None}],
            ["a fault"] if number == 1 else [],
        )


@pytest.fixture
def study(tmp_path):
    study = Study(tmp_path, SETTINGS)
    yield study
    study.close()


def again(study):
    """Open the same folder again; `with` closes it."""
    study.close()
    return closing(Study(study.folder.parent, SETTINGS))


def test_rows_stand_in_the_order_of_the_cells_not_of_the_work(study):
    keep(study, 2, 0, 1)
    expected = [
        {"ticks": number, "mode": "phase", "value": 0.1 * number, "none": None}
        for number in range(3)
    ]
    assert study.rows(CELLS) == expected
    with again(study) as back:
        assert back.rows(CELLS) == expected


def test_what_was_kept_is_there_again_and_only_that(study):
    keep(study, 0, 1)
    with again(study) as back:
        assert [cell in back for cell in CELLS] == [True, True, False]
        assert len(back) == 2
        assert back.spoiled() == ["a fault"]


def test_drafts_of_a_run_that_was_killed_are_removed(study):
    with pytest.raises(KeyboardInterrupt), whole_file(study.folder / "a.png") as draft:
        draft.touch()
        left = draft.rename(draft.with_name(draft.name + "2"))  # so that its end does not find it
        raise KeyboardInterrupt
    assert left.exists()
    with again(study):
        assert not left.exists()


def test_a_line_that_was_cut_short_was_not_kept_and_harms_nothing(study):
    keep(study, 0, 1)
    study.close()
    journal = study.folder / "cells.jsonl"
    whole = journal.read_bytes()
    for cut in range(len(whole.splitlines()[0]) + 2, len(whole)):
        journal.write_bytes(whole[:cut])
        back = Study(study.folder.parent, SETTINGS)
        assert [cell in back for cell in CELLS] == [True, False, False]
        keep(back, 1)
        back.close()
        assert journal.read_bytes() == whole


def test_parts_of_a_cell_add_up_until_it_is_complete(study):
    assert study.begun(CELLS[0]) is None
    study.keep_part(CELLS[0], Part([{"value": 0.1}], [1.5], 0.25))
    study.keep_part(CELLS[0], Part([{"value": 0.2}], [2.5], 0.5))
    with again(study) as back:
        assert back.begun(CELLS[0]) == Part([{"value": 0.1}, {"value": 0.2}], [2.5], 0.5)
        assert CELLS[0] not in back
        assert back.begun(CELLS[1]) is None
        assert back.complete == 0.5
        keep(back, 0, 1)
        assert back.complete == 2
        with again(back) as complete:
            assert complete.complete == 2


def test_a_damaged_journal_is_reported_in_words(study):
    keep(study, 0, 1)
    study.close()
    journal = study.folder / "cells.jsonl"
    journal.write_bytes(b"\x00garbage\n" + journal.read_bytes())
    with pytest.raises(WrongUse, match="damaged"):
        Study(study.folder.parent, SETTINGS)


def test_other_settings_have_a_folder_of_their_own(study, tmp_path):
    other = Study(tmp_path, {**SETTINGS, "seed": 2})
    assert other.folder != study.folder
    other.close()


def test_two_runs_do_not_work_in_one_folder(study, tmp_path):
    with pytest.raises(WrongUse, match="another run works"):
        Study(tmp_path, SETTINGS)
    study.close()
    Study(tmp_path, SETTINGS).close()


def test_a_folder_that_cannot_be_written_is_reported_in_words(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(WrongUse, match="cannot hold results"):
        Study(tmp_path / "file", SETTINGS)


def test_numbers_that_json_does_not_have_are_refused(study):
    with pytest.raises(ValueError, match="JSON"):
        study.keep(CELLS[0], [{"value": float("nan")}], [])
    with again(study) as back:
        assert CELLS[0] not in back


def test_the_table_has_a_line_for_each_row_and_every_column(study):
    study.keep(CELLS[0], [{"one": 1}, {"other": 2.5}], [])
    with study.write_table("toy", study.rows(CELLS[:1])).open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert rows == [
        {"ticks": "0", "mode": "phase", "one": "1", "other": ""},
        {"ticks": "0", "mode": "phase", "one": "", "other": "2.5"},
    ]
