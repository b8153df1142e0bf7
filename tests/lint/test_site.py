"""The site of the docs: it is built without a warning, and its search finds all that has a name."""

import json
import re
import subprocess
import sys
from collections import defaultdict

import pytest
from sphinx.search.en import SearchEnglish

import kickctl
import kickctl.theory
from host.cli import VERBS
from host.experiments.registry import TABLE as EXPERIMENTS
from host.perform.reproduce import claim_ids
from host.theory.studies.registry import TABLE as STUDIES
from robot.params import TABLE as PARAMS
from robot.record import NAMES as CHANNELS
from tests.faults.rows import ROWS
from tests.lint.sources import ROOT

# Where nothing is there yet, a busy machine takes its time for it.
pytestmark = pytest.mark.timeout(600)
# It stays there between runs: only pages that have changed are read.
SITE = ROOT / "build" / "docs-quick" / "html"
# What a browser fetches by itself, unlike what a reader clicks on.
FETCHED = re.compile(r"<(?!a )[^>]*(?:src|href)=\"((?:https?:)?//[^\"]*)")


@pytest.fixture(scope="module")
def site():
    done = subprocess.run(
        [sys.executable, "-m", "docs.site", "--quick"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return SITE


@pytest.fixture(scope="module")
def found(site):
    """Whether the search finds a name: as a title, or all of its words on one page."""
    text = (site / "searchindex.js").read_text(encoding="utf-8")
    index = json.loads(text[text.index("(") + 1 : text.rindex(")")])
    titles = {title.lower() for title in index["alltitles"]}
    places = defaultdict(set)
    for table in (index["titleterms"], index["terms"]):
        for word, pages in table.items():
            places[word.lower()] |= set(pages if isinstance(pages, list) else [pages])
    search = SearchEnglish({})

    def is_found(name):
        words = [word for word in search.split(name.lower()) if search.word_filter(word)]
        pages = [places[search.stem(word)] for word in words]
        return name.lower() in titles or (words and bool(set.intersection(*pages)))

    return is_found


@pytest.mark.parametrize(
    "names",
    [
        pytest.param(PARAMS, id="parameters"),
        pytest.param(CHANNELS, id="channels"),
        pytest.param([row.name for row in ROWS], id="faults"),
        pytest.param(claim_ids(), id="claims"),
        pytest.param(VERBS, id="verbs"),
        pytest.param([*EXPERIMENTS, *STUDIES], id="runs"),
        pytest.param([*kickctl.__all__, *kickctl.theory.__all__], id="public names"),
    ],
)
def test_the_search_finds_all_that_has_a_name(found, names):
    assert [name for name in names if not found(name)] == []
    assert not found("xylophone")


def test_tables_lead_to_the_pages_of_experiments(site):
    page = (site / "docs" / "experiments.html").read_text(encoding="utf-8")
    assert [name for name in EXPERIMENTS if f"experiment/{name}.html" not in page] == [
        name for name in EXPERIMENTS if name.startswith(("train-", "car-"))
    ]


def test_it_shows_itself_without_a_network(site):
    pages = sorted(site.rglob("*.html"))
    assert len(pages) > 50
    fetched = {page.name: FETCHED.findall(page.read_text(encoding="utf-8")) for page in pages}
    assert {name: links for name, links in fetched.items() if links} == {}
