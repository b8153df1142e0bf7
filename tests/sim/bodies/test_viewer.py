"""MuJoCo's viewer, with a window that is simulated."""

from types import SimpleNamespace

import pytest

from host.bodies.build import BodyRequest, build_body
from host.errors import NotDone
from host.films import body as film


def test_the_viewer_needs_a_display(monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(NotDone, match="display"), film.open_viewer(None, None):
        pass
    monkeypatch.setenv("DISPLAY", ":4711")  # where there is none
    with pytest.raises(NotDone, match="window"), film.open_viewer(None, None):
        pass


class Window:
    """Stands in for MuJoCo's window; its user closes it after some pictures."""

    def __init__(self, pictures):
        self.left, self.cam = pictures, SimpleNamespace()

    def __enter__(self):
        return self

    def __exit__(self, *error):
        pass

    def is_running(self):
        return self.left > 0

    def sync(self):
        self.left -= 1


def test_the_viewer_keeps_to_real_time_and_ends_with_its_window(monkeypatch):
    clock = SimpleNamespace(now=100.0)
    clock.monotonic = lambda: clock.now
    clock.sleep = lambda seconds: setattr(clock, "now", clock.now + seconds)
    viewer = pytest.importorskip("mujoco.viewer")
    monkeypatch.setenv("DISPLAY", ":4711")
    monkeypatch.setattr(film, "_try_window", lambda: None)
    monkeypatch.setattr(film, "time", clock)
    monkeypatch.setattr(viewer, "launch_passive", lambda *given, **options: Window(30))
    car = build_body(BodyRequest(seed=3))
    with film.open_viewer(car.model, car.data) as show:
        car.run(60.0, lambda _: show(car.data))
    # Of the body's records, every 5 ms, each fourth is the first after 1/60 s.
    assert car.time_s == pytest.approx(30 * 0.02, abs=0.03)
    assert clock.now - 100.0 == pytest.approx(car.time_s, abs=0.03)
