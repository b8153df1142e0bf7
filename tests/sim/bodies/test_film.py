"""Films: of a simulated body, by a camera that follows it, and of a wheel's rods.

Needs EGL (libegl1) or OSMesa, but no display.
"""

import json
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from imageio_ffmpeg import get_ffmpeg_exe
from PIL import Image

from host.bodies.build import BodyRequest, build_body
from host.errors import NotDone, WrongUse
from host.figures.robot import rods as figure
from host.films import body as film
from host.films.body import Camera, Film
from host.films.movie import Movie
from host.films.rod_course import WINDOW_S, course
from host.logs.log import Log
from robot.controller import motor_torque, rod_force, tangential_force
from tests.lint.sources import ROOT

SMALL = (160, 96)


def read(path):
    """All pictures of a film, (pictures, height, width, 3)."""
    folder = path.parent / "pictures"
    folder.mkdir()
    subprocess.run(
        [
            get_ffmpeg_exe(),
            "-loglevel",
            "error",
            "-i",
            path,
            "-fps_mode",
            "passthrough",
            folder / "%05d.png",
        ],
        check=True,
    )
    return np.array(
        [np.asarray(Image.open(picture).convert("RGB")) for picture in sorted(folder.iterdir())]
    ).astype(int)


def yellow(pictures):
    """Where the cars are."""
    return (pictures[..., 0] > 150) & (pictures[..., 1] > 120) & (pictures[..., 2] < 100)


@pytest.mark.parametrize("ending", ["mp4", "gif"])
def test_a_film_has_a_picture_for_each_moment_and_shows_what_moves(tmp_path, ending):
    path, car = tmp_path / f"car.{ending}", build_body(BodyRequest(seed=3))
    with Film(path, car.model, 1, size=SMALL, fps=10) as watch:
        car.run(0.505, lambda _: watch(car.data))
    seen = read(path)
    assert seen.shape == (
        6,
        SMALL[1],
        SMALL[0],
        3,
    )  # begun at the first call, after 5 ms; then every 0.1 s
    assert (yellow(seen).sum(axis=(1, 2)) > 20).all()
    assert np.abs(np.diff(seen, axis=0)).max(axis=(1, 2, 3)).min() > 50


def test_filming_changes_nothing_of_what_is_filmed(tmp_path):
    train, filmed = (build_body(BodyRequest(cars=2, seed=3)) for _ in range(2))
    train.run(0.3)
    with Film(tmp_path / "train.mp4", filmed.model, 2, size=SMALL) as watch:
        filmed.run(0.3, lambda _: watch(filmed.data))
    assert np.array_equal(train.rows, filmed.rows)


def test_the_camera_follows_smoothly_and_keeps_the_whole_train_in_the_picture():
    train = build_body(BodyRequest(cars=5, seed=3))
    camera, looked, edges = Camera(train.model, 5, SMALL, follow=0.08 / film.FOLLOW_S), [], []

    def watch(time_s):
        if round(time_s * 1000) % 80 == 0:
            rows, columns = np.nonzero(yellow(camera.picture(train.data)))
            edges.append(
                (rows.min(), SMALL[1] - rows.max(), columns.min(), SMALL[0] - columns.max())
            )
            looked.append(camera._view.lookat.copy())

    train.run(4.0, watch)
    camera.close()
    travel = np.linalg.norm(looked[-1] - looked[0])
    assert travel > 1.5  # or there is nothing to follow
    assert np.linalg.norm(np.diff(looked, axis=0), axis=1).max() < 4 * travel / len(looked)
    assert np.min(edges) > 2


def test_a_run_that_is_interrupted_leaves_a_film_that_plays(tmp_path):
    path, car = tmp_path / "car.mp4", build_body(BodyRequest(seed=3))

    def watch_until(watch, time_s):
        watch(car.data)
        if time_s > 0.2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt), Film(path, car.model, 1, size=SMALL, fps=10) as watch:
        car.run(5.0, lambda time_s: watch_until(watch, time_s))
    assert len(read(path)) == 3


@pytest.mark.parametrize(
    ("name", "word"),
    [
        ("car.avi", "'.avi'|car.avi"),
        ("car", "car"),
        ("nowhere/car.mp4", "nowhere"),
        ("d.gif", "d.gif"),
    ],
)
def test_a_film_that_cannot_be_written_is_refused_before_anything_runs(tmp_path, name, word):
    (tmp_path / "d.gif").mkdir()
    with pytest.raises(WrongUse, match=word) as refused:
        Film(tmp_path / name, build_body(BodyRequest()).model, 1)
    assert refused.value.hint
    assert [path.name for path in tmp_path.iterdir()] == ["d.gif"]


def test_a_full_disk_is_told_and_an_empty_film_leaves_no_file(tmp_path):
    full = tmp_path / "full.mp4"
    full.symlink_to("/dev/full")
    picture = np.random.default_rng(1).integers(0, 256, (96, 160, 3), np.uint8)
    with pytest.raises(NotDone, match="could not be written"), Movie(full, SMALL) as movie:
        for _ in range(5):
            movie.add(picture)
    with Movie(tmp_path / "none.mp4", SMALL):
        pass
    assert not (tmp_path / "none.mp4").exists()


NO_GL = """
import sys
from pathlib import Path
from host.bodies.build import BodyRequest, build_body
from host.errors import NotDone
from host.films.body import Film
try:
    Film(Path(sys.argv[1]), build_body(BodyRequest()).model, 1)
except NotDone as error:
    print(error.message, error.hint)
"""


@pytest.mark.parametrize(("name", "value"), [("MUJOCO_GL", "off"), ("MUJOCO_EGL_DEVICE_ID", "99")])
def test_where_nothing_can_draw_it_says_what_to_install(tmp_path, name, value):
    """Tried in a process of its own, as MuJoCo looks at these variables when it is loaded."""
    environment = {**os.environ, "MUJOCO_GL": "egl", name: value}
    command = [sys.executable, "-c", NO_GL, str(tmp_path / "car.mp4")]
    done = subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True
    )
    assert "no film can be made here" in done.stdout
    assert "MUJOCO_GL" in done.stdout
    assert "libegl1" in done.stdout
    assert list(tmp_path.iterdir()) == []


def test_without_egl_and_osmesa_it_says_so(monkeypatch):
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setattr(film, "find_library", lambda name: None)
    with pytest.raises(NotDone, match="neither EGL nor OSMesa") as refused:
        Film(Path("car.mp4"), build_body(BodyRequest()).model, 1)
    assert "libosmesa6" in refused.value.hint


def test_the_viewer_needs_a_display(monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(NotDone, match="display"), film.open_viewer(None, None):
        pass
    monkeypatch.setenv("DISPLAY", ":4711")  # where there is none
    with pytest.raises(NotDone, match="window"), film.open_viewer(None, None):
        pass


class Window:
    """In place of MuJoCo's: is closed by its user after so many pictures."""

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


def test_live_keeps_to_real_time_and_ends_with_its_window(monkeypatch):
    clock = SimpleNamespace(now=100.0)
    clock.monotonic = lambda: clock.now
    clock.sleep = lambda seconds: setattr(clock, "now", clock.now + seconds)
    viewer = pytest.importorskip("mujoco.viewer")
    monkeypatch.setenv("DISPLAY", ":4711")
    monkeypatch.setattr(film, "_try_window", lambda: None)
    monkeypatch.setattr(film, "time", clock)
    monkeypatch.setattr(viewer, "launch_passive", lambda *given, **options: Window(30))
    car = build_body(BodyRequest(seed=3))
    with film.open_viewer(car.model, car.data) as watch:
        car.run(60.0, lambda _: watch(car.data))
    assert car.time_s == pytest.approx(
        30 * 0.02, abs=0.03
    )  # every fourth record of 5 ms is the first after 1/60 s
    assert clock.now - 100.0 == pytest.approx(car.time_s, abs=0.03)


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    """The log of `kickctl rods`, run as a person would, and its film."""
    folder = tmp_path_factory.mktemp("rods")
    environment = {**os.environ, "KICK_TOKEN": str(folder / "token"), "PYTHONPATH": str(ROOT)}
    environment.pop("KICK_BRICK", None)
    command = [sys.executable, "-m", "host", "rods", "--out", "rods.gif", "--seed", "1", "--json"]
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=True
    )
    result = json.loads(done.stdout)
    assert result["reversed"]
    return Log.load(folder / result["log"]), folder / result["film"]


def test_the_film_of_the_rods_plays_and_is_small(log):
    with Image.open(log[1]) as gif:
        assert gif.size == figure.SIZE
        assert 5.0 < gif.n_frames * gif.info["duration"] / 1000 < 7.0
    assert log[1].stat().st_size < 2_000_000


@pytest.mark.parametrize("side", ["left", "right"])
def test_the_rods_that_are_shown_make_the_robots_torque(log, side):
    robot, tick_s = log[0], 0.03
    k, zero_s = robot.info["params"]["k"], robot.records[robot.kicks()[0][0]].t_s
    inside = [
        record
        for record in robot.records
        if WINDOW_S[0] < record.t_s - zero_s < WINDOW_S[1] - tick_s
    ]
    assert len(inside) > 30
    for record in inside:
        at_s = record.t_s - zero_s
        shown = course(robot, side, (max(WINDOW_S[0], at_s), at_s + 1e-3), 1e-3)
        forces = [
            rod_force(target, actual, k)
            for target, actual in zip(shown.targets[:, 0], shown.actual[:, 0], strict=True)
        ]
        torque = motor_torque(tangential_force(*forces, *shown.actual[:, 0]))
        assert torque == pytest.approx(getattr(record, side + "_torque"), abs=1e-9)
        assert shown.torque[0] == getattr(record, side + "_torque")


def test_a_kick_shows_the_neurons_another_place_only_while_it_acts(log):
    shown = course(log[0], "left", WINDOW_S, 0.01)
    altered = ~np.isnan(shown.seen[0])
    assert np.array_equal(altered, (shown.t_s > -1e-9) & (shown.t_s < shown.kick_s - 1e-9))
    turned = np.arctan2(shown.seen[1], shown.seen[0])[altered] - shown.phi[altered]
    assert np.cos(turned) == pytest.approx(np.cos(3 * np.pi / 4))
    assert (
        shown.phi[0] < shown.phi[np.searchsorted(shown.t_s, 0.0)] > shown.phi[-1]
    )  # forward, then backward


def test_pictures_of_the_rods_change_with_the_wheel_and_repeat_to_the_pixel(log):
    shown = course(log[0], "left", (-0.1, 0.2), 0.1)
    first, again = (np.array(list(figure.pictures(shown, 4.0))) for _ in range(2))
    assert first.shape == (3, figure.SIZE[1], figure.SIZE[0], 3)
    assert np.array_equal(first, again)
    machine = first[:, :, : figure.SIZE[0] // 2].astype(int)
    assert (np.abs(np.diff(machine, axis=0)).max(axis=3) > 50).sum(axis=(1, 2)).min() > 500


def test_a_log_without_a_kick_or_too_short_is_refused(log):
    with pytest.raises(NotDone, match="too little"):
        course(log[0], "left", (-1000.0, 1.0), 0.01)
    with pytest.raises(NotDone, match="no kick"):
        course(Log(), "left", WINDOW_S, 0.01)
