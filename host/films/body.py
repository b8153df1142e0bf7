"""Look at a simulated body.

A film by a camera that follows it, which needs no display; or MuJoCo's viewer in real time.
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
# The camera follows within FOLLOW_S (s). It is NEAR_M (m) away, and farther for a larger body: by
# FARTHER times the greatest distance of a car from the body's centre.
FOLLOW_S, NEAR_M, FARTHER = 0.3, 0.9, 3.0
AZIMUTH_DEG, ELEVATION_DEG = 125.0, -28.0
# The viewer may take this long to close (s), and shows a picture at most this often (s).
CLOSING_S, SHOW_S = 5.0, 1 / 60
# What can draw without a display, the best first, and the library that it needs.
_LIBRARIES = {"egl": "EGL", "osmesa": "OSMesa"}
_INSTALL = "on Debian: apt install libegl1, or libosmesa6"


class Film:
    """A film of a body as it runs, as fast as the simulated time.

    Use it in a `with` block, and call it with the body's mujoco.MjData whenever there may be
    something new. The environment variable MUJOCO_GL chooses what draws (egl or osmesa); by default
    it is the first that is installed.

    Args:
        path: of the film, .mp4 or .gif.
        model: the body's mujoco.MjModel.
        cars: how many cars the body has.
        size: width and height in pixels, both even.
        fps: pictures per second.
        new: whether the film's file must not exist.

    Raises:
        NotDone: if nothing here can draw.
        WrongUse: if the film cannot be written.
    """

    def __init__(
        self,
        path: Path,
        model: Any,
        cars: int,
        *,
        size: tuple[int, int] = SIZE,
        fps: float = FPS,
        new: bool = False,
    ) -> None:
        self._fps = fps
        self._start_s: float | None = None
        # A camera takes long to open: whether the film can be written is known at once.
        self._movie = Movie(path, size, fps, new=new)
        try:
            self._camera = Camera(model, cars, size, follow=1 / (fps * FOLLOW_S))
        except BaseException:
            self._movie.__exit__(None, None, None)
            raise

    def __enter__(self) -> Self:
        return self

    def __call__(self, data: Any) -> None:
        """Take a picture if it is time for one."""
        if self._start_s is None:
            self._start_s = data.time
        while self._movie.pictures <= self._fps * (data.time - self._start_s) + 1e-6:
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
    """A camera that follows a body.

    Args:
        model: the body's mujoco.MjModel.
        cars: how many cars the body has.
        size: width and height of its pictures in pixels.
        follow: the part of its way to the body that it goes from picture to picture.

    Raises:
        NotDone: if nothing here can draw.
    """

    def __init__(self, model: Any, cars: int, size: tuple[int, int], follow: float) -> None:
        import mujoco

        self._mujoco, self._model, self._size, self._follow = mujoco, model, size, min(1.0, follow)
        self._bodies = [model.body(f"car{car}_car").id for car in range(cars)]
        self._gl = _open_gl(size)
        # A scene may limit pictures to a smaller size.
        model.vis.global_.offwidth = max(size[0], model.vis.global_.offwidth)
        model.vis.global_.offheight = max(size[1], model.vis.global_.offheight)
        self._scene = mujoco.MjvScene(model, maxgeom=10000)
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = False
        self._scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        self._options = mujoco.MjvOption()
        self._drawing = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_150)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._drawing)
        self._view = mujoco.MjvCamera()
        self._view.azimuth, self._view.elevation = AZIMUTH_DEG, ELEVATION_DEG
        self._view.distance = 0.0  # until the first picture

    def picture(self, data: Any) -> Picture:
        """What the body looks like now.

        Args:
            data: the body's mujoco.MjData.

        Returns:
            The picture, (height, width, 3).
        """
        mujoco, view = self._mujoco, self._view
        self._gl.make_current()
        cars = data.xpos[self._bodies]
        centre = cars.mean(axis=0)
        if view.distance == 0.0:
            view.distance = NEAR_M + FARTHER * np.linalg.norm(cars - centre, axis=1).max()
            view.lookat[:] = centre
        view.lookat += self._follow * (centre - view.lookat)
        width, height = self._size
        everything = mujoco.mjtCatBit.mjCAT_ALL
        mujoco.mjv_updateScene(
            self._model, data, self._options, None, view, everything, self._scene
        )
        whole = mujoco.MjrRect(0, 0, width, height)
        mujoco.mjr_render(whole, self._scene, self._drawing)
        font, corner = mujoco.mjtFont.mjFONT_NORMAL, mujoco.mjtGridPos.mjGRID_TOPLEFT
        mujoco.mjr_overlay(font, corner, whole, f"{data.time:.1f} s", "", self._drawing)
        picture = np.empty((height, width, 3), np.uint8)
        mujoco.mjr_readPixels(picture, None, whole, self._drawing)
        return picture[::-1]

    def close(self) -> None:
        """Free what draws."""
        self._drawing.free()
        self._gl.free()


def _open_gl(size: tuple[int, int]) -> Any:
    """Open a place to draw in, without a display. Raises NotDone."""
    wanted = os.environ.get("MUJOCO_GL", "").strip().lower()
    name = wanted or next((name for name in _LIBRARIES if find_library(_LIBRARIES[name])), "")
    if not name:
        raise NotDone(
            "no film can be made here: there is neither EGL nor OSMesa to draw with", _INSTALL
        )
    try:
        context = import_module("mujoco." + name).GLContext(*size)
        context.make_current()
    except Exception as error:  # a broken OpenGL raises exceptions of any kind
        if wanted:
            cause = f"MUJOCO_GL={name}: {name} cannot draw ({error})"
            hint = f"unset MUJOCO_GL, or set it to {' or '.join(_LIBRARIES)}; {_INSTALL}"
        else:
            cause, hint = f"{name} cannot draw ({error})", _INSTALL
        raise NotDone(f"no film can be made here: {cause}", hint) from error
    return context


class _WindowClosed(Exception):
    """The user has closed the viewer's window."""


@contextmanager
def open_viewer(model: Any, data: Any) -> Iterator[Callable[[Any], None]]:
    """Open MuJoCo's viewer.

    When the user closes its window, the `with` block ends early, without an error.

    Args:
        model: the body's mujoco.MjModel.
        data: its mujoco.MjData.

    Yields:
        A function to call with the data whenever they change. It shows them, and waits until real
        time has caught up with simulated time.

    Raises:
        NotDone: if no window can be opened.
    """
    need("glfw", "bodies")
    has_display = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if sys.platform == "linux" and not has_display:
        raise NotDone(
            "the viewer needs a display, and there is none",
            "--film FILE.mp4 makes a film instead; over ssh, use ssh -X",
        )
    _try_window()
    import mujoco
    from mujoco import viewer

    cars = [number for number in range(model.nbody) if model.body(number).name.endswith("_car")]
    other_threads = set(threading.enumerate())
    try:
        with viewer.launch_passive(model, data, show_left_ui=False, show_right_ui=False) as window:
            window.cam.type = mujoco.mjtCamera.mjCAMERA_TRACKING
            window.cam.trackbodyid = cars[len(cars) // 2]
            window.cam.azimuth, window.cam.elevation = AZIMUTH_DEG, ELEVATION_DEG
            window.cam.distance = 2 * NEAR_M
            start_s, shown_s = time.monotonic() - data.time, -np.inf

            def show(data: Any) -> None:
                nonlocal shown_s
                if data.time - shown_s < SHOW_S:
                    return
                if not window.is_running():
                    raise _WindowClosed
                window.sync()
                shown_s = data.time
                time.sleep(max(0.0, start_s + data.time - time.monotonic()))

            with suppress(_WindowClosed):
                yield show
    finally:
        # The program would crash if it ended while a window is still drawing.
        for thread in set(threading.enumerate()) - other_threads:
            thread.join(CLOSING_S)


def _try_window() -> None:
    """Raise NotDone if no window can be opened; the viewer would wait for one for ever."""
    import warnings

    import glfw

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        works = glfw.init()
        glfw.terminate()
    if not works:
        cause = str(caught[-1].message) if caught else "GLFW does not say why"
        raise NotDone(
            f"the viewer cannot open a window: {cause}", "--film FILE.mp4 makes a film instead"
        )
