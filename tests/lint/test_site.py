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
from docs.site import reference
from host.cli import VERBS
from host.experiments.registry import TABLE as EXPERIMENTS
from host.link.sim_settings import settings
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


def test_what_a_robot_says_leads_to_what_to_do(search):
    messages = [
        "left motor (outB): its cable came off: plug it in",
        "right motor (outC): it does not stop: pull its cable out",
        "the watchdog has ended (signal 9)",
        "the battery is empty (5.9 V): charge it",
        "the battery is low (6.1 V): charge it",
        "left motor (outA): a lego-ev3-m-motor is there: plug in a large motor",
        "the left motor's angle is no number",
        "EIO",
        "was silent for 0.5 s",
        *(row.words for row in ROWS if row.words),
    ]
    found = search(messages)
    lost = [text for text, places in found.items() if not places[:1] or not leads(places[0])]
    assert lost == []


def leads(place):
    """Whether a place is the robot guide or the page of faults."""
    return place.startswith(("robot/README", "reference/faults"))


def test_settings_of_the_simulated_robot_lead_to_their_page(search):
    names = [setting.name for setting in settings()]
    found = search(names)
    page = "docs/simulated-robot"
    assert [
        name for name in names if not any(place.startswith(page) for place in found[name])
    ] == []


def test_the_page_of_faults_begins_with_what_the_robot_says():
    page = reference.pages()["reference/faults.md"]
    rows = {row.split(" | ")[-1].removesuffix(" |"): row for row in page.splitlines()}
    assert [row.name for row in ROWS if row.words not in rows[row.name].split(" | ")[0]] == []
    assert "clear`" not in rows["battery empty"]


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
