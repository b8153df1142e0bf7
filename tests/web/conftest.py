"""A real Chromium for the pages' tests."""

import shutil
from contextlib import ExitStack
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import sync_playwright

from host.lab.server import Lab
from host.lab.station import CONTINUE
from host.lab.stepped_station import SteppedStation

CHROMIUM = shutil.which("chromium")


# For a module, not for the session: while playwright runs in a thread, asyncio.run fails there.
@pytest.fixture(scope="module")
def browser():
    """A headless Chromium."""
    if CHROMIUM is None:
        pytest.skip("there is no Chromium here; get one by `apt-get install chromium`")
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield chromium
        chromium.close()


class Visitor:
    """A browser's page in the lab. It fails its test if it complains, or asks elsewhere.

    Attributes:
        page: The page, of playwright.
    """

    def __init__(self, browser, lab, url, **context):
        self._home = lab.drive_url.partition("#")[0]
        self.complaints = []
        self.context = browser.new_context(
            **{"viewport": {"width": 1280, "height": 720}, **context}
        )
        self.page = self.context.new_page()
        self.page.on("console", self._hear)
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("request", self._look)
        self.page.goto(url)

    def _hear(self, message):
        if message.type in ("error", "warning"):
            self.complaints.append(message.text)

    def _look(self, request):
        if not request.url.startswith((self._home, self._home.replace("http", "ws"), "blob:")):
            self.complaints.append("a request to " + request.url)

    def forgive(self, beginning):
        """Take no offence at complaints that begin like this."""
        self.complaints = [one for one in self.complaints if not one.startswith(beginning)]

    def state(self):
        """What the page knows."""
        return self.page.evaluate("lab.state()")

    def robot(self):
        """What the page knows of the robot that it shows."""
        state = self.state()
        return state["robots"][state["selected"]]

    def until(self, condition):
        """Wait until a condition on `s`, the page's state, and `r`, its robot, is true."""
        known = "const s = lab.state(), r = s.robots[s.selected]"
        self.page.wait_for_function(f"() => {{ {known}; return {condition}; }}")

    def reads(self, selector, words):
        """Wait until a part of the page says some words."""
        self.page.wait_for_function(
            "([selector, words]) => document.querySelector(selector).innerText.includes(words)",
            arg=[selector, words],
        )


@pytest.fixture
def station():
    """The robot of the lab: embedded, and its time passes only by `station.step`."""
    station = SteppedStation("sim://?seed=1", "anna", CONTINUE)
    yield station
    station.close()


@pytest.fixture
def lab(station):
    """A lab with one robot that rolls, and its server."""
    station.step(3)
    with Lab([station], port=0) as lab:
        yield lab


@pytest.fixture
def begin_again(lab, station):
    """A function that serves the same lab again, at the same address, after its end."""
    with ExitStack() as stack:

        def begin_again():
            again = Lab([station], port=urlsplit(lab.drive_url).port)
            vars(again.keys).update(vars(lab.keys))
            stack.enter_context(again)

        yield begin_again


@pytest.fixture
def visit(browser, lab):
    """A function that opens the lab's page, and waits until it knows the robot."""
    visitors = []

    def visit(url=None, **context):
        visitor = Visitor(browser, lab, url or lab.drive_url, **context)
        visitors.append(visitor)
        visitor.until("r && r.records > 0 && s.drawing.frames > 2")
        return visitor

    yield visit
    complaints = [words for visitor in visitors for words in visitor.complaints]
    for visitor in visitors:
        visitor.context.close()
    assert complaints == []
