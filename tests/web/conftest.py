"""A real Chromium for the pages' tests."""

import asyncio
import shutil
from contextlib import ExitStack
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import sync_playwright

from host.client.robot import Robot
from host.lab.server import Lab
from host.lab.station import CONTINUE
from host.lab.stepped_station import SteppedStation
from tests.web.visitor import DRAWN, Visitor
from tests.web.window import Window

CHROMIUM = shutil.which("chromium")
# The same engine without windows and tabs: a page opens in it for a third of the work.
SHELL = shutil.which("chromium-headless-shell") or CHROMIUM


@pytest.fixture(scope="session")
def chromium():
    """A headless Chromium, and the loop in which playwright talks to it, which rests."""
    if SHELL is None:
        pytest.skip("there is no Chromium here; get one by `apt-get install chromium`")
    with sync_playwright() as playwright:
        # Without a screen its graphics processor is a program, slower than drawing without one.
        chromium = playwright.chromium.launch(
            executable_path=SHELL, args=["--no-sandbox", "--disable-gpu"]
        )
        loop = asyncio.get_running_loop()
        asyncio._set_running_loop(None)
        yield chromium, loop
        asyncio._set_running_loop(loop)
        chromium.close()


# While the loop runs in this thread, as playwright wants it, asyncio.run fails here.
@pytest.fixture(scope="module")
def browser(chromium):
    """A headless Chromium without pages."""
    chromium, loop = chromium
    asyncio._set_running_loop(loop)
    yield chromium
    for context in chromium.contexts:
        context.close()
    asyncio._set_running_loop(None)


@pytest.fixture(scope="module")
def window(browser):
    """A function that gives the window of a test's first visitor, of its second, and so on."""
    windows = []

    def window(number):
        if number == len(windows):
            windows.append(Window(browser))
        return windows[number]

    return window


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
            return stack.enter_context(again)

        yield begin_again


@pytest.fixture
def visit(window, lab):
    """A function that opens the lab's page, and waits until it knows the robot."""
    visitors = []

    def visit(url=None, **context):
        visitor = Visitor(window(len(visitors)), url or lab.drive_url, **context)
        visitors.append(visitor)
        visitor.until(DRAWN)
        return visitor

    yield visit
    complaints = [words for visitor in visitors for words in visitor.complaints]
    for visitor in visitors:
        visitor.context.close()
    assert complaints == []


@pytest.fixture
def other_program(lab, station, monkeypatch):
    """Another program, called bert, that drives the robot of the lab."""
    link = station._link.another()
    with monkeypatch.context() as patch:
        patch.setattr("host.client.neighbours.client_id", lambda: "another program")
        other = Robot(link, link.token, "bert")
    with other:
        other.lease()
        station.step(0.3)
        yield other
