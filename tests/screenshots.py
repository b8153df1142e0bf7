"""Pictures of a pupil's path through the lab's page, for people to look at: `make screenshots`.

All of them go to build/screenshots; one of each size goes to docs/pictures, too, for README.md.
"""

import io
import shutil
import sys
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

from host.client.robot import connect
from host.lab.forecasts import Forecasts
from host.lab.live_twin import LiveTwin
from host.lab.one_file import one_file
from host.lab.server import Lab
from host.lab.station import CONTINUE
from host.lab.stepped_station import SteppedStation
from host.lab.tape import make_tape
from host.lab.worker import Worker
from tests.lint.sources import ROOT
from tests.web.jupyter import Notebook, jupyter_lab

SIZES = {"desk": (1280, 720), "phone": (390, 844), "projector": (1920, 1080)}
ALL = ROOT / "build/screenshots"
BEST = ROOT / "docs/pictures"
# Flat drawings need no more colours, and then a picture is small.
COLOURS = 256
FOREVER_MS = 60000


def walk(page, station):
    """Go along the path, and yield the name of each picture when its moment has come."""

    def until(condition):
        known = "const s = lab.state(), r = s.robots[s.selected]"
        page.wait_for_function(f"() => {{ {known}; return {condition}; }}", timeout=FOREVER_MS)

    until("r && r.records > 200 && r.basins?.side === 64")
    yield "1-wheels-turn"
    page.check("#guess-0", force=True)
    page.wait_for_selector("#kick-phase >> text=is what the simulation expects", state="attached")
    yield "2-guess"
    page.click("#kick-phase")
    until("r.kicks.length > 0 && r.kicks.at(-1).mode === 'phase'")
    station.step(0.06)
    yield "3-kicked"
    station.step(2.4)
    until("r.kicks.at(-1).outcome && r.kicks.at(-1).prediction")
    yield "4-reversed"
    page.keyboard.press("Escape")
    station.step(1.5)
    until("r.state === 'stopped' && Object.values(s.stop)[0] === 'confirmed'")
    yield "5-stopped"


def save(png, name, method=Image.Quantize.MAXCOVERAGE):
    """Write a picture with few colours. Returns its path."""
    ALL.mkdir(parents=True, exist_ok=True)
    path = ALL / f"{name}.png"
    picture = Image.open(io.BytesIO(png)).convert("RGB")
    # By MAXCOVERAGE a small mark keeps its colour.
    picture.quantize(COLOURS, method=method, dither=Image.Dither.NONE).save(path, optimize=True)
    return path


def main():
    """Take all pictures. Returns the exit status."""
    chromium = shutil.which("chromium")
    if chromium is None:
        print("there is no Chromium here; get one by `apt-get install chromium`", file=sys.stderr)
        return 1
    BEST.mkdir(parents=True, exist_ok=True)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        forecasts, basins = Forecasts(), Worker("computes basins", 0)
        for place, (width, height) in SIZES.items():
            take(browser, place, {"width": width, "height": height}, forecasts, basins)
        forecasts.close()
        basins.close()
        take_twin(browser)
        take_replay(browser)
        take_notebook(browser)
        browser.close()
    return 0


def take(browser, place, viewport, forecasts, basins):
    """Take the pictures of one size, each size with a robot of its own."""
    station = SteppedStation("sim://?seed=3", "simulated", CONTINUE)
    station.step(10)
    with Lab([station], port=0, forecasts=forecasts, basins=basins) as lab:
        page = browser.new_page(viewport=viewport)
        page.goto(lab.drive_url)
        for moment in walk(page, station):
            page.mouse.move(0, 0)
            page.wait_for_timeout(400)  # so that what has just changed is on the screen
            path = save(page.screenshot(), f"{place}-{moment}")
            print(path.relative_to(ROOT), f"{path.stat().st_size / 1000:.0f} kB")
            if moment == "4-reversed":
                shutil.copy(path, BEST / f"lab-{place}.png")
        page.close()
    station.close()


def take_twin(browser):
    """Take a picture of a robot and its twin after a kick."""
    station = SteppedStation("sim://?seed=3", "anna", CONTINUE, LiveTwin())
    station.step(5)
    with Lab([station], port=0) as lab:
        page = browser.new_page(viewport={"width": 1366, "height": 768})
        page.goto(lab.drive_url)
        page.click("#kick-phase")
        page.wait_for_function("() => lab.state().robots[0].kicks.length")
        for _ in range(60):
            station.step(0.09)
            page.wait_for_timeout(90)
        page.wait_for_function("() => lab.state().twins[0].compared")
        page.mouse.move(0, 0)
        path = save(page.screenshot(), "twin")
        shutil.copy(path, BEST / "lab-twin.png")
        page.close()
    station.close()


def take_replay(browser):
    """Take a picture of a replay, in a tick of a phase kick."""
    with connect("sim://?seed=3") as robot, robot.recording() as log:
        robot.wait(10.0)
        robot.kick("phase", ticks=4, wheel="left")
        robot.wait(5.0)
        robot.kick("membrane")
        robot.wait(5.0)
    page = browser.new_page(viewport={"width": 1280, "height": 720})
    page.set_content(one_file(make_tape(log, "phase-and-membrane.mcap")))
    page.wait_for_function("() => window.lab")
    page.locator("#time").fill(str(log.kicks()[0][0] + 1))
    page.evaluate("document.activeElement.blur()")
    page.wait_for_timeout(400)
    path = save(page.screenshot(), "replay")
    shutil.copy(path, BEST / "lab-replay.png")
    page.close()


def take_notebook(browser):
    """Take a picture of a robot in a notebook, some time after a kick has reversed its wheels."""
    cells = [
        'from kickctl import connect\n\nrobot = connect("sim://?seed=3")\nrobot.show()',
        'robot.wait(5)\nprint(robot.kick_and_watch("phase", ticks=4, wheel="left"))',
    ]
    with tempfile.TemporaryDirectory() as folder, jupyter_lab(Path(folder), cells) as url:
        notebook = Notebook(browser, url)
        notebook.page.set_viewport_size({"width": 1040, "height": 880})
        notebook.command("application:toggle-left-area")
        for number in range(2):
            notebook.run(number)
            notebook.ended(number)
        notebook.until(0, "s.shown_s === s.record.t_s")
        notebook.page.evaluate("document.querySelector('.jp-WindowedPanel-outer').scrollTop = 0")
        notebook.page.wait_for_timeout(400)
        png = notebook.page.locator(".jp-WindowedPanel-outer").screenshot()
        path = save(png, "notebook", Image.Quantize.MEDIANCUT)
        shutil.copy(path, BEST / "notebook.png")
        notebook.page.close()


if __name__ == "__main__":
    sys.exit(main())
