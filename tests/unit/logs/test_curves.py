"""What pictures of a log show is what the log says: kicks as they acted, stops, gaps, one time."""

import numpy as np
import pytest

from host.errors import NotDone
from host.figures.robot.kick import spans
from host.figures.robot.log import POINTS, _thin
from host.films.log_course import frames, times
from host.logs.curves import COLUMNS, curves
from host.logs.log import Log
from tests.fakes import Rig, eventful


@pytest.fixture(scope="module")
def log():
    return eventful().log()


def test_columns_are_the_logs(log):
    found = curves(log.stream())
    zero_s = log.records[0].t_s
    assert found.t_s == pytest.approx(log.column("t_s") - zero_s, abs=1e-9)
    for name in COLUMNS:
        assert found.values[name].tobytes() == log.column(name).astype(float).tobytes()
    assert found.tick.tolist() == log.column("tick").tolist()
    assert set(found.a.tolist()) == {4.0, 5.5}
    assert found.running.tolist() == [record.state == 1 for record in log.records]
    assert found.breaks == []


def test_parameters_that_changed_are_not_those_of_the_log(log):
    """A figure's corner has those that stayed the same."""
    params = curves(log.stream()).params
    assert not {"a", "k", "tick_s"} & params.keys()
    assert (params["link_loss_s"], params["duty_scale"]) == (0.5, 1.0)


def test_kicks_last_as_long_as_they_acted(log):
    """The other way to find them looks from the kick's event forward, in memory."""
    zero_s = log.records[0].t_s
    expected = [(span.begin_s - zero_s, span.end_s - zero_s) for span in spans(log)]
    found = [(one.begin_s, one.end_s) for one in curves(log.stream()).kicks]
    assert len(found) == len(expected) > 30
    assert np.array(found) == pytest.approx(np.array(expected), abs=1e-9)


def test_stops_faults_and_restarts_are_marked_and_time_goes_on(log):
    longer = Log()
    log.play(longer)
    longer.take_event({"event": "restart", "tick": 0})
    log.play(longer)
    found = curves(longer.stream())
    names = [name for _, name in found.stops]
    once = [event["event"] for event in log.events if event["event"] in ("stop", "fault")]
    assert len(once) > 2
    assert names == [*once, "restart", *once]
    assert np.all(np.diff(found.t_s) > 0.0)
    assert found.breaks == [len(log)]
    assert len(found.kicks) == 2 * len(curves(log.stream()).kicks)


def test_missing_ticks_break_the_curves(log):
    short = Log()
    short.take_records(log.records[:10] + log.records[15:20])
    assert curves(short.stream()).breaks == [10]


def test_long_curves_are_thinned_without_losing_a_peak():
    t = np.arange(100 * POINTS, dtype=float)
    values = np.sin(t / 1000)
    values[12345] = 7.0
    thin_t, thin = _thin(t, values)
    assert len(thin) == len(thin_t) < 1.1 * POINTS
    assert (thin.max(), thin.min()) == (7.0, values.min())
    assert np.all(np.diff(thin_t) >= 0.0)


def test_a_film_shows_the_wheels_as_logged_with_kicks_and_stops(log):
    found = curves(log.stream())
    shown = list(frames(found, times(found, 0.0, None, 0.04)))
    for number in (0, 100, len(shown) - 1):
        frame = shown[number]
        for side in ("left", "right"):
            phi = np.interp(frame.t_s, found.t_s, found.values[side + "_phi_rad"])
            assert frame.wheels[side].phi == phi
            assert frame.wheels[side].actual == pytest.approx([np.cos(phi), np.sin(phi)])
    assert {"stop", "fault", "not running", ""} == {frame.word for frame in shown}
    altered = {
        frame.kick["mode"] for frame in shown if np.isfinite(frame.wheels["left"].seen).all()
    }
    assert altered == {"position", "phase", "pulse", "waveform"}
    for frame in shown:
        if frame.kick is None or "right" not in frame.kick["wheels"]:
            assert np.isnan(frame.wheels["right"].seen).all()


def test_a_part_of_a_log_can_be_filmed_and_nothing_cannot():
    rig = Rig()
    rig.loop.start()
    rig.run(100)
    found = curves(rig.log().stream())
    assert times(found, 1.0, 0.5, 0.1) == pytest.approx([1.0, 1.1, 1.2, 1.3, 1.4])
    assert times(found, 1.0, None, 0.1)[-1] <= found.t_s[-1]
    with pytest.raises(NotDone, match="nothing to film"):
        times(found, 1000.0, None, 0.1)
