"""The kick figure shows what the log holds.

Every curve, every kick where it acted, gaps as gaps, in letters one can read.
"""

import struct
import subprocess
import sys
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.text import Text

from host.figures.robot.kick import Span, draw, spans
from host.logs.log import Log
from tests.fakes import Rig
from tests.small_figures import small_figures

ROOT = Path(__file__).resolve().parents[3]
PAPER = {
    "left_x1": "saddlebrown",
    "left_x2": "darkorange",
    "right_x1": "mediumblue",
    "right_x2": "deepskyblue",
}


@pytest.fixture
def drawn(monkeypatch, tmp_path):
    """Draws, and returns the figure that was saved: small, if it is not the layout that counts."""

    def draw_and_keep(log, window=None, *, small=True):
        figures = []
        save = Figure.savefig
        with monkeypatch.context() as patch, small_figures() if small else nullcontext():
            patch.setattr(
                Figure,
                "savefig",
                lambda figure, *args, **kwargs: (
                    figures.append(figure),
                    save(figure, *args, **kwargs),
                ),
            )
            draw(log, tmp_path / "kick.png", "A kick", window)
        return figures[0]

    return draw_and_keep


def kicked(tick=0):
    """A log with a phase kick at tick 50 and a membrane kick of the left wheel at tick 70."""
    rig = Rig()
    rig.loop.start()
    rig.run(50)
    rig.kick("phase", ticks=4)
    rig.run(20)
    rig.kick("membrane", wheel="left")
    rig.run(30)
    return rig.log(tick)


def curve(axes, color):
    """The data of the one line of a colour."""
    [line] = [
        line
        for line in axes.lines
        if to_hex(line.get_color()) == to_hex(color) and len(line.get_xdata()) > 2
    ]
    return np.asarray(line.get_xdata()), np.asarray(line.get_ydata())


def test_the_curves_are_the_columns(drawn):
    log = kicked()
    neurons, speeds = drawn(log).axes
    time = log.column("t_s") - log.records[50].t_s
    for name, color in PAPER.items():
        x, y = curve(neurons, color)
        assert np.array_equal(x, time)
        assert np.array_equal(y, log.column(name))
    for side, color in (("left", "black"), ("right", "grey")):
        assert np.array_equal(curve(neurons, color)[1], log.column(side + "_torque"))
        assert np.array_equal(curve(speeds, color)[1], log.omega(side) / (2 * np.pi))
    [band] = [patch for patch in neurons.patches if "stall" in str(patch.get_label())]
    assert (band.get_y(), band.get_height()) == (-0.1, 0.2)


def test_every_kick_in_the_window_is_marked_and_named_and_no_other(drawn):
    log = kicked()

    def names(figure):
        return {text.get_text() for text in figure.axes[0].texts}

    def marked(figure, number):
        crimson = [
            patch
            for patch in figure.axes[number].patches
            if to_hex(patch.get_facecolor()) == to_hex("crimson")
        ]
        return [(patch.get_x(), patch.get_x() + patch.get_width()) for patch in crimson]

    figure = drawn(log)
    zero_s = log.records[50].t_s
    assert names(figure) == {"phase kick, 4 ticks", "membrane kick, 1 tick, left wheel"}
    expected = [
        (0.0, log.records[54].t_s - zero_s),
        (log.records[70].t_s - zero_s, log.records[71].t_s - zero_s),
    ]
    for number in (0, 1):
        assert np.allclose(marked(figure, number), expected, atol=1e-12)
    early = drawn(log, (-1.0, 0.3))
    assert names(early) == {"phase kick, 4 ticks"}
    assert early.axes[0].get_xlim() == early.axes[1].get_xlim() == (-1.0, 0.3)


def test_a_kick_ends_where_it_ended():
    rig = Rig()
    rig.loop.start()
    rig.run(10)
    rig.kick("position", ticks=50)
    rig.run(5)
    rig.loop.stop("enough")
    rig.run(5)
    rig.loop.start()
    rig.kick("phase")
    rig.loop.stop("before it could act")
    rig.run(5)
    rig.loop.start()
    rig.kick("phase", ticks=9)
    rig.run(3)
    log = rig.log()
    first, last = log.records[10], log.records[-1]
    assert spans(log) == [
        Span(first.t_s, log.records[15].t_s, "position kick, 50 ticks"),
        Span(log.records[25].t_s, last.t_s + last.dt_s, "phase kick, 9 ticks"),
    ]


def test_names_of_kicks_close_to_each_other_do_not_overlap(drawn):
    rig = Rig()
    rig.loop.start()
    rig.run(40)
    for _ in range(4):
        rig.kick("membrane", wheel="right")
        rig.run(3)
    rig.run(20)
    figure = drawn(rig.log(), small=False)
    boxes = [text.get_window_extent() for text in figure.axes[0].texts]
    assert len(boxes) == 4
    assert not any(
        one.overlaps(other) for number, one in enumerate(boxes) for other in boxes[:number]
    )
    frame = figure.bbox
    assert all(
        frame.x0 <= box.x0 and box.x1 <= frame.x1 and frame.y0 <= box.y0 and box.y1 <= frame.y1
        for box in boxes
    )


def test_a_gap_is_no_curve(drawn):
    whole = kicked()
    log = Log()
    log.take_records(whole.records[:20] + whole.records[45:])
    x, y = curve(drawn(log).axes[0], "saddlebrown")
    assert np.flatnonzero(np.isnan(x)).tolist() == np.flatnonzero(np.isnan(y)).tolist() == [20]


def test_only_the_latest_run_of_a_restarted_robot_is_drawn(drawn):
    log = kicked()
    log.take_event({"event": "restart", "tick": 0, "boot": "b"})
    Rig(seed=3).feed(log)
    log.take_records(kicked().records[:30])
    figure = drawn(log)
    assert len(curve(figure.axes[0], "darkorange")[0]) == 30
    assert not figure.axes[0].texts
    assert figure.axes[1].get_xlabel() == "time (s)"


def test_the_figure_fits_a_projector(drawn, tmp_path):
    figure = drawn(kicked(), (-1.0, 1.5), small=False)
    png = (tmp_path / "kick.png").read_bytes()
    assert png.startswith(b"\x89PNG\r\n\x1a\n")
    width, height = struct.unpack(">II", png[16:24])
    assert width == 1920
    assert 800 <= height <= 1200
    shown = [text for text in figure.findobj(Text) if text.get_text() and text.get_visible()]
    assert {"A kick", "time since the kick (s)"} <= {text.get_text() for text in shown}
    assert min(text.get_fontsize() for text in shown) >= 12


def test_a_log_without_ticks_cannot_be_drawn(tmp_path):
    with pytest.raises(ValueError, match="no ticks"):
        draw(Log(), tmp_path / "kick.png", "nothing")
    assert not (tmp_path / "kick.png").exists()


def test_drawing_needs_no_display():
    code = "import sys, host.figures.robot.kick; sys.exit('matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=False).returncode == 0
