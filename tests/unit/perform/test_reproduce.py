"""Which claims `kickctl reproduce` tries, in which order, and which ones it skips."""

import pytest

from host.experiments.registry import BODIES, TABLE
from host.perform import reproduce
from host.runs.claims import Claim
from host.runs.presets import ORDINARY, PAPER, PRESETS


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
        return {"claims": claims, "seed": 1, "version": "", "commit": ""}

    def entry(name):
        return {**TABLE, **reproduce.STUDIES}[name]

    known = reproduce.claim_ids()
    monkeypatch.setattr(reproduce, "find_spec", lambda module: library or None)
    monkeypatch.setattr(reproduce, "perform", perform)
    monkeypatch.setattr(reproduce.report, "write", lambda path, *_: path)
    done = reproduce.reproduce(uri, out=tmp_path)
    assert all(reason in done.skipped[number] for number in ("B1", "B2", "B3"))


def test_a_simulated_robot_is_measured_in_the_other_setting_too(monkeypatch, tmp_path):
    """Each claim stands beside itself; the model, the bodies and a real robot have one setting."""
    runs = []

    def perform(name, *_, preset="ordinary", **__):
        runs.append((name, preset))
        own = {**TABLE, **reproduce.STUDIES}[name].claims
        claims = [Claim(number, "", "", None, "1", None, holds=preset == PAPER) for number in own]
        return {
            "claims": [claim.as_dict() for claim in claims],
            "seed": 1,
            "version": "",
            "commit": "",
        }

    monkeypatch.setattr(reproduce, "perform", perform)
    monkeypatch.setattr(reproduce.report, "write", lambda path, *_: path)
    done = reproduce.reproduce("sim://", only=["R8", "R14", "M3"], out=tmp_path)
    both = [(name, preset) for preset in PRESETS for name in ("reliability", "chaos")]
    assert sorted(runs) == sorted([*both, ("hopf", ORDINARY)])
    assert [(claim.id, claim.holds) for claim in done.claims] == [
        ("R8", False),
        ("R14", False),
        ("M3", False),
    ]
    assert {number: claim.holds for number, claim in done.at_preset.items()} == {
        "R8": True,
        "R14": True,
    }
    runs.clear()
    assert reproduce.reproduce("tcp://robot:5425", only=["R8"], out=tmp_path).at_preset == {}
    assert runs == [("reliability", ORDINARY)]
