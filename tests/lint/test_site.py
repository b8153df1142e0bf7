"""The site of the docs: it is built without a warning, and its search finds all that has a name."""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

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
def search(site):
    """A function that gives the places that the site's search finds for queries, best first."""
    if shutil.which("node") is None:
        pytest.skip("there is no Node.js here; get it by `apt-get install npm`")

    def search(queries):
        program = Path(__file__).with_name("search.js")
        command = ["node", str(program), str(site), *queries]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        return dict(zip(queries, json.loads(done.stdout), strict=True))

    return search


@pytest.mark.parametrize(
    ("page", "names"),
    [
        pytest.param("reference/parameters#", PARAMS, id="parameters"),
        pytest.param("reference/channels", CHANNELS, id="channels"),
        pytest.param("reference/faults", [row.name for row in ROWS], id="faults"),
        pytest.param("docs/claims", claim_ids(), id="claims"),
        pytest.param("reference/{}", VERBS, id="verbs"),
        pytest.param("reference/experiment/{}", EXPERIMENTS, id="experiments"),
        pytest.param("reference/theory/{}", STUDIES, id="studies"),
        pytest.param("reference/python#kickctl.{}", kickctl.__all__, id="kickctl"),
        pytest.param(
            "reference/python-theory#kickctl.theory.{}", kickctl.theory.__all__, id="kickctl.theory"
        ),
    ],
)
def test_the_search_leads_from_each_name_to_its_page(search, page, names):
    found = search(names)
    lost = [
        name
        for name, places in found.items()
        if not any(place.startswith(page.format(name)) for place in places)
    ]
    assert lost == []


def test_words_that_people_type_lead_to_their_answer_first(search):
    robot, words = "robot/README#", "host/GLOSSARY#"
    answers = {
        "motor does not turn": robot,
        "fault": robot,
        "battery": robot,
        "wifi": robot,
        "lights": robot,
        "emergency stop": robot,
        "stall": words,
        "k_c": words,
        "Hopf": "docs/theory#",
        "reverse": words,
    }
    found = search(answers)
    firsts = {word: found[word][0][: len(page)] for word, page in answers.items()}
    assert firsts == answers
    assert search(["xylophone"]) == {"xylophone": []}


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
