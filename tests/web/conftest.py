"""A real Chromium for the pages' tests."""

import shutil
from contextlib import ExitStack
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import sync_playwright

from host.lab.server import Lab
from host.lab.station import CONTINUE
from host.lab.stepped_station import SteppedStation
from tests.web.visitor import Visitor

CHROMIUM = shutil.which("chromium")
# The same engine without windows and tabs: a page opens in it for a third of the work.
SHELL = shutil.which("chromium-headless-shell") or CHROMIUM


# For a module, not for the session: while playwright runs in a thread, asyncio.run fails there.
@pytest.fixture(scope="module")
def browser():
    """A headless Chromium."""
    if SHELL is None:
        pytest.skip("there is no Chromium here; get one by `apt-get install chromium`")
    with sync_playwright() as playwright:
        # Without a screen its graphics processor is a program, slower than drawing without one.
        chromium = playwright.chromium.launch(
            executable_path=SHELL, args=["--no-sandbox", "--disable-gpu"]
        )
        yield chromium
        chromium.close()


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
