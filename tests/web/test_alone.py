"""The page that runs the robot by itself: `make page`, a plain file server, a real Chromium."""

import base64
import functools
import http.server
import threading

import pytest
from playwright.sync_api import sync_playwright

from host.lab.static_page import RUNTIME, build
from tests.lab.own_lab import Visit, records_of
from tests.lint.sources import ROOT
from tests.web.conftest import SHELL
from tests.web.visitor import Visitor

# Keeps the records that the worker sends.
KEEP_RECORDS = """
    window.kept = [];
    window.Worker = class extends Worker {
        constructor(...given) {
            super(...given);
            this.addEventListener("message", ({ data }) => {
                if (typeof data === "string") return;
                window.kept.push(btoa(String.fromCharCode(...new Uint8Array(data))));
            });
        }
    };
"""
# An earlier release of this page, and another folder's page.
OTHER_CACHES = """
    for (const place of [".", "../other/"]) {
        caches.open(`kickctl ${new URL(place, location)} old`);
    }
"""
PYODIDE = ROOT / "build/pyodide/node_modules/pyodide"
# A busy machine takes its time to compile 10 MB of WebAssembly.
PATIENCE_MS = 120_000
SMALL = {"width": 640, "height": 400}
ROLLS = "r && r.records > 60 && r.state === 'running'"


class Files(http.server.SimpleHTTPRequestHandler):
    """What any web server does."""

    def log_message(self, *_):
        pass


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The folder that `make page` makes."""
    if not all((PYODIDE / name).is_file() for name in RUNTIME):
        pytest.skip("Pyodide is not here; get it by `make page`")
    folder = tmp_path_factory.mktemp("site") / "page"
    assert build(folder, PYODIDE) > 10e6
    return folder


@pytest.fixture(scope="module")
def browser():
    """A headless Chromium that compiles WebAssembly only once, not a second time for speed."""
    if SHELL is None:
        pytest.skip("there is no Chromium here; get one by `apt-get install chromium`")
    with sync_playwright() as playwright:
        arguments = ["--no-sandbox", "--disable-gpu", "--js-flags=--liftoff-only"]
        chromium = playwright.chromium.launch(executable_path=SHELL, args=arguments)
        yield chromium
        chromium.close()


@pytest.fixture
def served(folder):
    """The folder behind a plain file server, in a folder of its site."""
    handler = functools.partial(Files, directory=folder.parent)
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    server.drive_url = f"http://127.0.0.1:{server.server_port}/page/"

    def end():
        server.shutdown()
        server.server_close()
        thread.join()

    server.end = end
    yield server
    end()


def kick(visitor, mode):
    """Kick by the page's button. Returns what came of it, by wheel."""
    visitor.page.click(f"#kick-{mode}")
    visitor.until(f"r.kicks.at(-1)?.mode === '{mode}' && r.kicks.at(-1).outcome")
    return visitor.robot()["kicks"][-1]["outcome"]["result"]


def same_ticks(records, kick, until):
    """Compare a page's records, from a kick's first tick on, with CPython's for the same kick.

    All that is a whole number, and the wheels' angles, must be the same. The rest comes out of
    exp, tanh, sine and cosine, whose last bits are others in another libm.
    """
    twin = Visit(seed=1)
    while len(twin.records) < kick["begin"] - 1:
        twin.wait(0.02)
    twin.do("kick", mode=kick["mode"], ticks=kick["ticks"])
    twin.wait(until * 0.03)
    own, other = (
        {record.tick: record for record in one if record.tick < until}
        for one in (records, twin.records)
    )
    assert own.keys() == other.keys()
    assert max(own) > kick["begin"] + 20
    for tick, record in own.items():
        for name, value in record._asdict().items():
            inexact = name.endswith(("_x1", "_x2", "_force", "_torque"))
            wanted = getattr(other[tick], name)
            assert value == (pytest.approx(wanted, abs=1e-12) if inexact else wanted), (tick, name)


def test_a_page_without_a_server_kicks_stops_and_opens_offline(browser, served):
    url, script = served.drive_url + "?seed=1", KEEP_RECORDS + OTHER_CACHES
    visitor = Visitor(browser, url, script=script, viewport=SMALL)
    page = visitor.page
    asked = []
    page.on("request", lambda request: asked.append(request.url))
    page.set_default_timeout(PATIENCE_MS)
    visitor.until(ROLLS)
    assert visitor.robot()["name"] == "simulated"
    assert page.is_hidden("#state .identify")  # there is one robot only
    assert "`" not in page.locator("body").inner_text()
    assert set(kick(visitor, "phase").values()) == {"reverses"}
    kept = page.evaluate("kept")
    records = [one for message in kept for one in records_of(base64.b64decode(message))]
    same_ticks(records, visitor.robot()["kicks"][-1], until=records[-1].tick)
    assert set(kick(visitor, "membrane").values()) == {"reverses"}
    page.keyboard.press("Escape")
    visitor.until("r.state === 'stopped' && s.stop.simulated === 'confirmed'")
    page.fill("#param-k", "5")
    page.keyboard.press("Enter")
    visitor.until("r.status.params.k === 5")
    visitor.reads("#state", "Controlled by\nthis page")
    page.evaluate("navigator.serviceWorker.ready.then(() => true)")
    page.wait_for_function("navigator.serviceWorker.controller?.state === 'activated'")
    other, own = sorted(page.evaluate("caches.keys()"))
    assert other == f"kickctl {served.drive_url.replace('/page/', '/other/')} old"
    assert own.startswith(f"kickctl {served.drive_url} ")
    assert not own.endswith(" old")
    served.end()
    page.reload()
    visitor.until(ROLLS)
    assert visitor.robot()["status"]["params"]["k"] == 8.0  # another robot begins
    visitor.reads("#state", "sim://?seed=1\n")  # with the same seed
    page.goto(served.drive_url + "?seed=abc")
    visitor.until("s.note?.message.includes('abc')")
    assert visitor.complaints == []
    # What keeps the page from asking elsewhere does not count for its worker.
    assert any("pyodide" in one for one in asked)
    assert [one for one in asked if not one.startswith(served.drive_url)] == []
    visitor.context.close()
