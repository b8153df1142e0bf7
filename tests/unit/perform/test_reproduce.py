"""Which claims `kickctl reproduce` tries, in which order, and which ones it skips."""

import pytest

from host.experiments.registry import BODIES, TABLE
from host.perform import reproduce
from host.runs.claims import Claim


def test_the_claims_come_after_those_of_robot_and_model():
    known = reproduce.claim_ids()
    assert known[-3:] == ["B1", "B2", "B3"]
    assert known[0] == "R1"


@pytest.mark.parametrize(
    ("uri", "library", "reason"),
    [("tcp://robot:5425", True, "by name"), ("sim://", False, "mujoco")],
)
def test_reproduce_skips_the_bodies_on_a_robot_and_without_mujoco(
    monkeypatch, tmp_path, uri, library, reason
):
    def perform(name, *_, **__):
        assert name not in BODIES
        claims = [
            Claim(number, "", "", 1.0, "1", None, holds=True).as_dict()
            for number in known
            if number in entry(name).claims
        ]
        return {"claims": claims, "seed": 1, "version": ""}

    def entry(name):
        return {**TABLE, **reproduce.STUDIES}[name]

    known = reproduce.claim_ids()
    monkeypatch.setattr(reproduce, "find_spec", lambda module: library or None)
    monkeypatch.setattr(reproduce, "perform", perform)
    monkeypatch.setattr(reproduce.report, "write", lambda path, *_: path)
    done = reproduce.reproduce(uri, out=tmp_path)
    assert all(reason in done.skipped[number] for number in ("B1", "B2", "B3"))
