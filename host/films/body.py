"""Looking at a simulated body.

A film by a camera that follows it, without any display, or MuJoCo's viewer in real time.
"""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from ctypes.util import find_library
from importlib import import_module
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from host.errors import NotDone
from host.films.movie import FPS, Movie, Picture
from host.util.extras import need

SIZE = (960, 540)
# How long (s) the camera takes to follow, and from how far (m) it looks: at a point, and so many
# times the body's greatest half more.
FOLLOW_S, NEAR_M, FURTHER = 0.3, 0.9, 3.0
AZIMUTH_DEG, ELEVATION_DEG = 125.0, -28.0
# How long (s) the viewer may take to close.
CLOSING_S = 5.0
# What draws without a display, the best first, and the library that it needs.
_LIBRARIES = {"egl": "EGL", "osmesa": "OSMesa"}
_INSTALL = "on Debian: apt install libegl1, or libosmesa6"


class Film:
    """A film of a body as it runs.

    An instance is called with its mujoco.MjData as often as there may be something new.

    path: .mp4 or .gif. cars: how many the body has. The film runs as fast as the simulated time.
    Raises, when it is made and so before anything runs, NotDone if nothing here can draw and
    WrongUse if the film cannot be written. MUJOCO_GL chooses what draws (egl, osmesa); else what
    there is does.
    """

    def __init__(
        self, path: Path, model: Any, cars: int, *, size: tuple[int, int] = SIZE, fps: float = FPS
    ) -> None:
        self._fps, self._begun_s = fps, -1.0
        self._camera = Camera(model, cars, size, follow=1 / (fps * FOLLOW_S))
        try:
            self._movie = Movie(path, size, fps)
        except BaseException:
            self._camera.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __call__(self, data: Any) -> None:
        """Take a picture if it is time for one."""
        if self._begun_s < 0.0:
            self._begun_s = data.time
        while self._movie.pictures <= self._fps * (data.time - self._begun_s) + 1e-6:
            self._movie.add(self._camera.picture(data))

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._camera.close()
        self._movie.__exit__(kind, error, trace)


class Camera:
    """Takes pictures of size (width, height) of a body of so many cars.

    From picture to picture it goes the part `follow` of its way.
    """

    def __init__(self, model: Any, cars: int, size: tuple[int, int], follow: float) -> None:
        import mujoco

        self._mujoco, self._model, self._size, self._follow = mujoco, model, size, min(1.0, follow)
        self._bodies = [model.body(f"car{car}_car").id for car in range(cars)]
        self._gl = _context(size)
        # Scenes may have been written for smaller pictures.
        model.vis.global_.offwidth = max(size[0], model.vis.global_.offwidth)
        model.vis.global_.offheight = max(size[1], model.vis.global_.offheight)
        self._scene, self._options, self._view = (
            mujoco.MjvScene(model, maxgeom=10000),
            mujoco.MjvOption(),
            mujoco.MjvCamera(),
        )
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = self._scene.flags[
            mujoco.mjtRndFlag.mjRND_REFLECTION
        ] = False
        self._drawing = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_150)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._drawing)
        self._view.azimuth, self._view.elevation, self._view.distance = (
            AZIMUTH_DEG,
            ELEVATION_DEG,
            0.0,
        )

    def picture(self, data: Any) -> Picture:
        """What it looks like now, (height, width, 3)."""
        mujoco, view = self._mujoco, self._view
        self._gl.make_current()
        cars = data.xpos[self._bodies]
        centre = cars.mean(axis=0)
        if view.distance == 0.0:
            view.distance = NEAR_M + FURTHER * np.linalg.norm(cars - centre, axis=1).max()
            view.lookat[:] = centre
        view.lookat += self._follow * (centre - view.lookat)
        width, height = self._size
        place, picture = mujoco.MjrRect(0, 0, width, height), np.empty((height, width, 3), np.uint8)
        mujoco.mjv_updateScene(
            self._model, data, self._options, None, view, mujoco.mjtCatBit.mjCAT_ALL, self._scene
        )
        mujoco.mjr_render(place, self._scene, self._drawing)
        clock = f"{data.time:.1f} s"
        mujoco.mjr_overlay(
            mujoco.mjtFont.mjFONT_NORMAL,
            mujoco.mjtGridPos.mjGRID_TOPLEFT,
            place,
            clock,
            "",
            self._drawing,
        )
        mujoco.mjr_readPixels(picture, None, place, self._drawing)
        return picture[::-1]

    def close(self) -> None:
        """Give back what draws."""
        self._drawing.free()
        self._gl.free()


def _context(size: tuple[int, int]) -> Any:
    """A place to draw in. Raises NotDone."""
    chosen = os.environ.get("MUJOCO_GL", "").strip().lower()
    asked = f"MUJOCO_GL={chosen}: " if chosen else ""
    chosen = chosen or next(
        (name for name, library in _LIBRARIES.items() if find_library(library)), ""
    )
    if not chosen:
        raise NotDone(
            "no film can be made here: there is neither EGL nor OSMesa to draw with", _INSTALL
        )
    try:
        context = import_module("mujoco." + chosen).GLContext(*size)
        context.make_current()
    except (
        Exception
    ) as error:  # what is wrong with a system's OpenGL comes as any kind of exception
        hint = (
            f"unset MUJOCO_GL, or set it to {' or '.join(_LIBRARIES)}; " if asked else ""
        ) + _INSTALL
        raise NotDone(
            f"no film can be made here: {asked}{chosen} cannot draw ({error})", hint
        ) from error
    return context


class _Closed(Exception):
    """Whoever watched has closed the window."""


@contextmanager
def live(model: Any, data: Any) -> Iterator[Callable[[Any], None]]:
    """MuJoCo's viewer: yields what to call with the data as they change, which holds them back to real time. Raises NotDone.

    When its window is closed, the `with` block ends early, without an error.
    """
    need("glfw", "bodies")
    if sys.platform == "linux" and not (
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    ):
        raise NotDone(
            "the viewer needs a display, and there is none",
            "--film FILE.mp4 makes a film instead; over ssh, use ssh -X",
        )
    _try_window()
    import mujoco
    from mujoco import viewer

    cars = [number for number in range(model.nbody) if model.body(number).name.endswith("_car")]
    others = set(threading.enumerate())
    try:
        with viewer.launch_passive(model, data, show_left_ui=False, show_right_ui=False) as window:
            window.cam.type, window.cam.trackbodyid = (
                mujoco.mjtCamera.mjCAMERA_TRACKING,
                cars[len(cars) // 2],
            )
            window.cam.azimuth, window.cam.elevation, window.cam.distance = (
                AZIMUTH_DEG,
                ELEVATION_DEG,
                2 * NEAR_M,
            )
            begun_s, shown_s = time.monotonic() - data.time, -np.inf

            def watch(data: Any) -> None:
                nonlocal shown_s
                if data.time - shown_s < 1 / 60:
                    return
                if not window.is_running():
                    raise _Closed
                window.sync()
                shown_s = data.time
                time.sleep(max(0.0, begun_s + data.time - time.monotonic()))

            with suppress(_Closed):
                yield watch
    finally:
        # A window that still draws while the program ends takes the program down with it.
        for thread in set(threading.enumerate()) - others:
            thread.join(CLOSING_S)


def _try_window() -> None:
    """Raises NotDone if no window can be opened, for which the viewer would wait for ever."""
    import warnings

    import glfw

    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        works = glfw.init()
        glfw.terminate()
    if not works:
        words = str(said[-1].message) if said else "GLFW does not say why"
        raise NotDone(
            f"the viewer cannot open a window: {words}", "--film FILE.mp4 makes a film instead"
        )
