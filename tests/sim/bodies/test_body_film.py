"""The film of a body, by a camera that follows it.

Needs EGL (libegl1) or OSMesa, but no display.
"""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from imageio_ffmpeg import get_ffmpeg_exe
from PIL import Image

from host.bodies.build import BodyRequest, build_body
from host.errors import NotDone, WrongUse
from host.films import body as film
from host.films.body import Camera, Film
from tests.lint.sources import ROOT

SMALL = (160, 96)


def read(path):
    """All pictures of a film, (pictures, height, width, 3)."""
    folder = path.parent / "pictures"
    folder.mkdir()
    ffmpeg = [get_ffmpeg_exe(), "-loglevel", "error"]
    subprocess.run(
        [*ffmpeg, "-i", path, "-fps_mode", "passthrough", folder / "%05d.png"], check=True
    )
    pictures = [Image.open(picture).convert("RGB") for picture in sorted(folder.iterdir())]
    return np.array([np.asarray(picture) for picture in pictures]).astype(int)


def yellow(pictures):
    """Where the cars are."""
    return (pictures[..., 0] > 150) & (pictures[..., 1] > 120) & (pictures[..., 2] < 100)


@pytest.mark.parametrize("ending", ["mp4", "gif"])
def test_a_film_has_a_picture_for_each_moment_and_shows_what_moves(tmp_path, ending):
    path, car = tmp_path / f"car.{ending}", build_body(BodyRequest(seed=3))
    with Film(path, car.model, 1, size=SMALL, fps=10) as watch:
        car.run(0.505, lambda _: watch(car.data))
    seen = read(path)
    # The first picture is from 5 ms, the first call; then there is one every 0.1 s.
    assert seen.shape == (6, SMALL[1], SMALL[0], 3)
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
