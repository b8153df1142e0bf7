"""Basins under the lag plane: drawn, said, switched off, and never those of other parameters."""

import pytest


class Halves:
    """Stands in for the process that computes: all starts with a lag above 0 lead forward.

    Attributes:
        waits: Whether it keeps its answers back.
    """

    def __init__(self):
        self.waits = False
        self.asked = []

    def ask(self, work, question, done):
        self.asked.append(question)
        side = question.side
        row = "b" * (side // 2) + "f" * (side // 2)
        ends = "".join("r" * side if n == side - 1 else row for n in range(*question.rows))
        picture = {"ends": ends, "phi_rad": 0.0, "radius": 0.32, "fastest": 3.0}
        if not self.waits:
            done(picture)


@pytest.fixture
def halves(lab, station):
    station.basins = Halves()
    return station.basins


# Whether the ground low in the lag plane's box, at a part of its width, is greener than red by at
# least and at most these amounts, on average.
LOOK = """
([part, least, most]) => {
    const canvas = document.querySelector("#lag-plane");
    const [width, height] = [canvas.width, canvas.height].map((n) => n / devicePixelRatio);
    const box = window.layout({}, { text: 13 }, width, height);
    const x = Math.round((box.left + part * box.width) * devicePixelRatio);
    const y = Math.round((box.top + 0.9 * box.height) * devicePixelRatio);
    const copy = new OffscreenCanvas(16, 16).getContext("2d", { willReadFrequently: true });
    copy.drawImage(canvas, x - 8, y - 8, 16, 16, 0, 0, 16, 16);
    const { data } = copy.getImageData(0, 0, 16, 16);
    let greener = 0;
    for (let n = 0; n < data.length; n += 4) greener += (data[n + 1] - data[n]) / 256;
    return least <= greener && greener <= most;
}
"""


def sees(visitor, part, least, most):
    """Wait until the plane's ground has this colour."""
    visitor.page.evaluate(
        "async () => { window.layout = (await import('/draw/plane.js')).layout; scrollTo(0, 0); }"
    )
    visitor.page.wait_for_function(LOOK, arg=[part, least, most])


def test_basins_are_drawn_and_said_but_never_those_of_other_parameters(visit, station, halves):
    visitor = visit()
    visitor.until("r.basins?.side === 64")
    assert sorted({question.side for question in halves.asked}) == [16, 32, 64]
    visitor.reads("#basins", "forward 49 %")
    visitor.reads("#basins", "φ = 0, x₁ and x₂ on a circle of radius 0.32")
    label = visitor.page.get_attribute("#lag-plane", "aria-label")
    assert "lead to: forward 49 %, backward 49 %, rest 2 %" in label
    sees(visitor, 0.75, 5, 255)
    sees(visitor, 0.25, -255, -3)

    halves.waits = True
    visitor.page.fill("#param-k", "3.5")
    visitor.page.keyboard.press("Enter")
    visitor.until("r.status.params.k === 3.5 && !r.basins")
    visitor.reads("#basins", "For a = 4, τ = 0.25 s, k = 3.5: being computed")
    assert "%" not in visitor.page.get_attribute("#lag-plane", "aria-label")
    sees(visitor, 0.75, -3, 3)


def test_the_switch_remembers_and_why_there_are_none_is_said(visit, station, halves):
    visitor = visit()
    visitor.until("r.basins?.side === 64")
    visitor.page.click("#basins-switch")
    visitor.until("!r.basins")
    assert visitor.page.inner_text("#basins").strip() == ""
    visitor.page.reload()
    visitor.until("r && r.records > 0")
    visitor.page.wait_for_selector("#basins-switch[aria-pressed=false]")
    asked = len(halves.asked)
    visitor.page.click("#basins-switch")
    visitor.until("r.basins")
    assert len(halves.asked) == asked  # they were known
    station._walls_m = 2.0
    halves.waits = True
    visitor.page.reload()
    visitor.reads(
        "#basins", "No basins: basins are of a wheel by itself, and this robot has walls."
    )
