"""What a class sees of the lab on a projector: texts within drawings, and the verdict in full."""

import pytest

from tests.web.test_basins import Halves
from tests.web.test_beside import robot, show  # noqa: F401 - a fixture
from tests.web.test_page import Forecast, kick

# Notes each text that a drawing writes: its height, and where its letters are, in CSS pixels. After
# each frame, what is too small, cut or covered by another text is kept as a complaint.
LISTEN = """
() => {
    const written = new Map();
    window.texts = { seen: {}, complaints: new Set() };
    const fillText = CanvasRenderingContext2D.prototype.fillText;
    CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
        fillText.call(this, text, x, y);
        if (!text) return;
        const ink = this.measureText(text);
        const box = {
            text,
            height: parseFloat(this.font.match(/([\\d.]+)px/)[1]),
            left: x - ink.actualBoundingBoxLeft,
            right: x + ink.actualBoundingBoxRight,
            top: y - ink.actualBoundingBoxAscent,
            bottom: y + ink.actualBoundingBoxDescent,
        };
        written.set(this.canvas, [...(written.get(this.canvas) ?? []), box]);
    };
    const look = () => {
        for (const [canvas, boxes] of written) {
            const complain = (what) => texts.complaints.add(`${canvas.id}: ${what}`);
            const [width, height] = [canvas.clientWidth, canvas.clientHeight];
            boxes.forEach((box, n) => {
                const { text } = box;
                texts.seen[canvas.id] = { ...texts.seen[canvas.id], [text]: box.height };
                if (box.height < innerHeight / 40) complain(`${text} is ${box.height} px high`);
                if (box.left < 0 || box.right > width || box.top < 0 || box.bottom > height)
                    complain(`${text} is cut`);
                for (const other of boxes.slice(0, n)) {
                    const aside = box.left >= other.right || other.left >= box.right;
                    const apart = box.top >= other.bottom || other.top >= box.bottom;
                    if (!aside && !apart) complain(`${text} covers ${other.text}`);
                }
            });
        }
        written.clear();
        requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
}
"""
# The texts beside drawings that are too small.
SMALL = """
() => {
    const words = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    const seen = [...document.querySelectorAll("input[type=number]")].map((one) => [one.id, one]);
    while (words.nextNode()) {
        const { data, parentElement } = words.currentNode;
        if (data.trim() && !parentElement.closest(".unseen")) seen.push([data, parentElement]);
    }
    const height = (element) => parseFloat(getComputedStyle(element).fontSize);
    return seen
        .filter(([, element]) => element.checkVisibility() && height(element) < innerHeight / 40)
        .map(([text]) => text);
}
"""
FRAMES = """
(count) => new Promise((done) => {
    const next = () => (count-- > 0 ? requestAnimationFrame(next) : done());
    next();
})
"""


@pytest.fixture(params=[(1920, 1080), (1280, 720)], ids=["1080", "720"])
def projector(request, visit, lab, station):
    """A page on a projector."""
    station.forecasts = Forecast({"reverses": 31, "continues": 1, "stops": 0}, 32)
    station.basins = Halves()
    width, height = request.param
    visitor = visit(viewport={"width": width, "height": height})
    if visitor.page.get_attribute("#projector", "aria-pressed") == "false":
        visitor.page.click("#projector")
    visitor.page.wait_for_selector("html.projector")
    return visitor


def test_texts_in_drawings_are_large_and_do_not_cover_each_other(projector, station):
    page = projector.page
    page.evaluate(FRAMES, 3)
    page.evaluate(LISTEN)
    page.evaluate(FRAMES, 10)
    kick(projector, station, "#kick-phase")
    for _ in range(5):
        station.step(0.2)
        page.evaluate(FRAMES, 3)
    page.keyboard.press("Escape")
    station.step(1.0)
    page.evaluate(FRAMES, 5)
    page.locator("#floor").scroll_into_view_if_needed()
    page.evaluate(FRAMES, 10)
    page.locator("#k-plane").scroll_into_view_if_needed()
    page.evaluate(FRAMES, 10)
    texts = page.evaluate("({ ...texts, complaints: [...texts.complaints] })")
    assert texts["complaints"] == []
    assert set(texts["seen"]) == {
        "left-wheel",
        "right-wheel",
        "strips",
        "lag-plane",
        "floor",
        "k-plane",
    }
    assert {"M", "ω", "rad/s", "x₁", "forward"} <= set(texts["seen"]["left-wheel"])
    assert {"x", "M", "ω"} <= set(texts["seen"]["strips"])


@pytest.mark.parametrize("names", [("anna", "bert"), ("anna", "bert", "carl")], ids=len)
@pytest.mark.parametrize("size", [(1920, 1080), (1280, 720)], ids=["1080", "720"])
def test_texts_of_robots_side_by_side_are_large_too(show, names, size):  # noqa: F811
    stations = [robot(number, name) for number, name in enumerate(names)]
    visitor = show(*stations, viewport={"width": size[0], "height": size[1]})
    page = visitor.page
    if page.get_attribute("#projector", "aria-pressed") == "false":
        page.click("#projector")
    page.wait_for_selector("html.projector")
    page.evaluate(FRAMES, 3)
    page.evaluate(LISTEN)
    page.click("#kick-position")
    visitor.until("s.robots[0].kicks.length === 1")
    for _ in range(4):
        for station in stations:
            station.step(0.03)
        page.evaluate(FRAMES, 3)
    texts = page.evaluate("({ ...texts, complaints: [...texts.complaints] })")
    assert texts["complaints"] == []
    assert {"Left", "Right", "Position", "turns/s", "lag"} <= set(texts["seen"][""])


def test_texts_beside_drawings_are_large_too(projector, station):
    for fold in ("#parameters summary", ".own summary"):
        projector.page.click(fold)
    kick(projector, station, ".kick.own")
    assert projector.page.evaluate(SMALL) == []


def test_no_button_moves_when_it_says_what_is_expected(projector, station):
    shares = {"reverses": 1, "continues": 95, "stops": 0}  # the longest words
    station.forecasts = Forecast(shares, 96)

    def places():
        return [one.bounding_box() for one in projector.page.locator(".three .kick").all()]

    before = places()
    projector.page.check("#guess-0", force=True)
    for mode in ("membrane", "position", "phase"):
        projector.reads(f"#kick-{mode}", "95/96 continue")
    assert places() == before


@pytest.mark.parametrize("stopped", [False, True], ids=["runs", "stopped"])
def test_the_verdict_is_seen_without_scrolling(projector, station, stopped):
    projector.page.check("#guess-0", force=True)
    kick(projector, station, "#kick-phase")
    projector.reads(".verdict", "The simulation 1 of 1.")
    if stopped:
        projector.page.keyboard.press("Escape")
        station.step(1.0)
        projector.until("r.state === 'stopped'")
        projector.reads("#kicks", "Start it to kick it.")
    low, rail = projector.page.evaluate(
        """["#kicks .score-line", "#kicks"].map(
            (part) => document.querySelector(part).getBoundingClientRect().bottom)"""
    )
    assert low <= min(rail, projector.page.viewport_size["height"])
    assert projector.page.evaluate("document.querySelector('#kicks').scrollTop + scrollY") == 0
