"""docs/claims.md and README.md say what `kickctl reproduce` has answered."""

from docs.site.claims import PAGE, load, rendered
from host.perform.reproduce import claim_ids
from host.runs.claim_sentences import SENTENCES
from host.runs.claims import FAILS, HOLDS
from tests.lint.sources import ROOT


def test_the_page_has_what_was_measured():
    page = PAGE.read_text(encoding="utf-8")
    assert page == rendered(page), "write it by: python -m docs.site.claims"
    assert [number for number in claim_ids() if f"\n| {number} | " not in page] == []


def test_the_data_has_every_claim_and_where_it_comes_from():
    answer = load()
    assert [claim["id"] for claim in answer["claims"]] == claim_ids()
    assert answer["skipped"] == {}
    assert answer["commit"]
    assert answer["seed"] == 1


def test_help_has_the_same_sentences():
    assert {claim["id"]: claim["claim"] for claim in load()["claims"]} == SENTENCES


def test_the_readme_counts_them():
    verdicts = [claim["verdict"] for claim in load()["claims"]]
    rods = 1  # B4, which `kickctl rods` shows
    count = f"{verdicts.count(HOLDS) + rods} of {len(verdicts) + rods} hold"
    readme = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    assert count in readme
    assert verdicts.count(FAILS) == 2
    assert "Two do not hold" in readme
