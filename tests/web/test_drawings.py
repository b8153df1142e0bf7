"""The lab's drawings in a real Chromium: what is where, and that nothing makes them throw."""

from pathlib import Path

import pytest

PAGE = Path(__file__).resolve().parents[2] / "host/lab/page"
DRAWINGS = ("wheel", "strips", "plane", "floor", "score")
ADDRESS = "http://drawings.test/"
# Makes a canvas and a theme, lets a module draw, and keeps both for questions about them.
SCRIPT = """
    import { theme } from "/theme.js";
    const modules = {};
    for (const name of %s) modules[name] = await import(`/draw/${name}.js`);
    window.draw = (name, state, { width, height, scale = 1, dark = false, projector = false }) => {
        const canvas = document.createElement("canvas");
        [canvas.width, canvas.height] = [width * scale, height * scale];
        const look = theme({ dark, scale, height }, projector);
        modules[name].draw(canvas, state, look);
        return { canvas, look, module: modules[name] };
    };
"""


@pytest.fixture(scope="module")
def page(browser):
    """A page that has the drawings, and nothing else."""
    page = browser.new_page()
    page.route("**/*", _serve)
    page.goto(ADDRESS)
    page.add_script_tag(content=SCRIPT % list(DRAWINGS), type="module")
    page.wait_for_function("() => Boolean(window.draw)")
    yield page
    page.close()


def _serve(route):
    name = route.request.url.removeprefix(ADDRESS)
    if name:
        route.fulfill(body=(PAGE / name).read_text("utf-8"), content_type="text/javascript")
    else:
        route.fulfill(body="<!doctype html><title>drawings</title>", content_type="text/html")


@pytest.mark.parametrize("name", DRAWINGS)
@pytest.mark.parametrize(
    ("width", "height", "scale"), [(320, 240, 1), (1280, 720, 1), (400, 300, 2)]
)
def test_it_draws_what_is_not_known_yet(page, name, width, height, scale):
    size = {"width": width, "height": height, "scale": scale}
    page.evaluate("([name, size]) => void draw(name, {}, size)", [name, size])
