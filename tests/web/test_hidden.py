"""The lab's page while nobody can see it: in a tab behind another, and in a minimized window."""

import asyncio

import pytest

from host.lab.station import CONTINUE, STOP
from host.lab.stepped_station import SteppedStation
from tests.web.conftest import CHROMIUM
from tests.web.tabs import open_browser
from tests.web.visitor import DRAWN

pytestmark = pytest.mark.skipif(
    CHROMIUM is None, reason="there is no Chromium here; get one by `apt-get install chromium`"
)
PATIENCE_S = 60.0


@pytest.fixture
def station(request):
    """A robot with a rule of what happens when nobody attends to it."""
    station = SteppedStation("sim://?seed=1", "anna", request.param)
    yield station
    station.close()


def visit(lab, story):
    """Open the lab's page in a browser of its own, and let a story happen to it.

    Args:
        lab: The lab.
        story: A coroutine function of the page's tab, a function that hides it, and one that shows
            it again.
    """

    async def visit():
        async with asyncio.timeout(PATIENCE_S), open_browser(CHROMIUM) as open_tab:
            tab = await open_tab(lab.drive_url)
            await tab.until(DRAWN)

            async def hide(way):
                if way == "minimized":
                    await tab.size_window("minimized")
                else:
                    await open_tab("about:blank")
                await tab.until_true("document.visibilityState === 'hidden'")

            async def show(way):
                if way == "minimized":
                    await tab.size_window("normal")
                else:
                    await tab.show()

            await story(tab, hide, show)

    asyncio.run(visit())


@pytest.mark.parametrize(
    ("station", "way"), [(STOP, "another tab"), (CONTINUE, "minimized")], indirect=["station"]
)
def test_a_hidden_page_draws_nothing_and_gives_the_robot_back(lab, station, way):
    async def story(tab, hide, show):
        await tab.press("#kick-phase")
        await tab.until("s.baton.you && r.kicks.length === 1")
        await hide(way)
        drawn = await tab.ask("lab.state().drawing.frames")
        tick = await tab.ask("lab.state().robots[0].record.tick")
        station.step(0.3)
        await tab.until(f"r.record.tick > {tick}")  # it goes on hearing
        await tab.until("s.baton.driver === null && s.baton.why.includes('silent')")
        state = "stopped" if station.rule == STOP else "running"
        await tab.until(f"r.state === '{state}'")
        assert await tab.ask("lab.state().drawing.frames") == drawn
        await show(way)
        await tab.until(f"s.drawing.frames > {drawn + 3}")
        if station.rule == STOP:
            await tab.press(".remedy")
        else:
            await tab.press("#kick-membrane")
        await tab.until("s.baton.you && r.state === 'running'")

    visit(lab, story)
