"""Write pictures, one after the other, to a film: .mp4 by ffmpeg, or .gif by Pillow."""

from __future__ import annotations

import os
import subprocess
import zlib
from collections.abc import Iterator
from contextlib import ExitStack
from errno import ENOSPC
from pathlib import Path
from select import select
from signal import SIGKILL
from tempfile import TemporaryFile
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from host.errors import NotDone, WrongUse
from host.util.extras import need
from host.util.whole_files import whole_file

Picture = NDArray[np.uint8]

FPS = 25
# How long (s) ffmpeg may take for a picture, or for the end of the film.
PATIENCE_S = 120.0
# How many colours a GIF has, and from how many of its pictures they are chosen.
_COLOURS, _SAMPLES = 64, 12


class Movie:
    """A film, to be written in a `with` block.

    If the block ends early, the pictures up to then make a film that plays. Without any picture
    there is no file.

    Args:
        path: of the film; its ending, .mp4 or .gif, says how it is written.
        size: width and height in pixels, both even.
        fps: pictures per second.
        new: whether the file must not exist.

    Attributes:
        path: of the film.
        pictures: how many have been added.

    Raises:
        WrongUse: if the ending is unknown, or the file cannot be written, or, if it must be `new`,
            exists already.
        NotDone: in the block or at its end, if the film cannot be finished.
    """

    def __init__(
        self, path: Path, size: tuple[int, int], fps: float = FPS, *, new: bool = False
    ) -> None:
        writers: dict[str, type[_Mp4 | _Gif]] = {".mp4": _Mp4, ".gif": _Gif}
        ending = path.suffix.lower()
        if ending not in writers:
            raise WrongUse(
                f"a film cannot be written as '{path.name}'",
                f"end its name with {' or '.join(writers)}",
            )
        if ending == ".mp4":
            need("imageio_ffmpeg", "bodies")
        self._exit = ExitStack()
        try:
            # The film gets its name when it plays. Until then, what was there before stays.
            self._draft = self._exit.enter_context(whole_file(path, new=new))
            with self._draft.open("ab"):
                pass
        except OSError as error:
            raise WrongUse(
                f"the film {path} cannot be written: {error.strerror}",
                "name a file in a folder that exists",
            ) from error
        self.path, self.pictures, self._plays = path, 0, False
        self._start_writer, self._size, self._fps = writers[ending], size, fps
        self._writer: _Mp4 | _Gif | None = None

    def __enter__(self) -> Self:
        return self

    def add(self, picture: Picture) -> None:
        """Add the next picture.

        Args:
            picture: (height, width, 3).

        Raises:
            NotDone: if the film cannot be written.
        """
        if self._writer is None:
            self._writer = self._start_writer(self._draft, self._size, self._fps, self.path)
        self._plays = False
        self._writer.add(np.ascontiguousarray(picture))
        self._plays = True
        self.pictures += 1

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        try:
            with self._exit:
                if self._writer is not None:
                    self._writer.finish()
                if not self._plays:
                    self._draft.unlink()  # so that it does not get the film's name
        except OSError as failure:
            raise NotDone(
                f"the film {self.path} could not be written: {failure.strerror or failure}",
                "is the disk full?" if failure.errno == ENOSPC else "choose another place",
            ) from failure


class _Mp4:
    """Writes H.264, which every player and browser shows.

    ffmpeg has a session of its own, so that Ctrl-C reaches this program only, and ffmpeg can finish
    the film.
    """

    def __init__(self, path: Path, size: tuple[int, int], fps: float, name: Path) -> None:
        from imageio_ffmpeg import get_ffmpeg_exe

        self._name = name
        width, height = size
        source = f"-f rawvideo -pix_fmt rgb24 -s {width}x{height} -r {fps:g} -i pipe:"
        film = "-c:v libx264 -crf 22 -pix_fmt yuv420p -movflags +faststart -f mp4 -y"
        command = [get_ffmpeg_exe(), "-loglevel", "error", *source.split(), *film.split()]
        # A file, because ffmpeg would wait for a reader of a full pipe.
        self._errors = TemporaryFile()  # noqa: SIM115 - closed in `finish`
        self._process = subprocess.Popen(
            [*command, str(path.resolve())],
            bufsize=0,
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=self._errors,
            start_new_session=True,
        )
        assert self._process.stdin is not None
        self._pipe = self._process.stdin.fileno()
        os.set_blocking(self._pipe, False)

    def add(self, picture: Picture) -> None:
        left = picture.data.cast("B")
        while left:
            if not select([], [self._pipe], [], PATIENCE_S)[1]:
                self._process.kill()
                raise self._failure()
            try:
                left = left[os.write(self._pipe, left) :]
            except BrokenPipeError:
                raise self._failure() from None

    def finish(self) -> None:
        """End the film. Raises NotDone if it is not whole, unless `add` has said so."""
        if self._process.stdin is None or self._process.stdin.closed:
            return
        self._process.stdin.close()
        try:
            failed = self._process.wait(PATIENCE_S) != 0
        except subprocess.TimeoutExpired:
            self._process.kill()
            failed = True
        if failed:
            raise self._failure()
        self._errors.close()

    def _failure(self) -> NotDone:
        """What went wrong, when ffmpeg has ended or was ended."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        with self._errors:
            if self._process.wait() == -SIGKILL:
                cause = f"ffmpeg did nothing for {PATIENCE_S:g} s"
                return NotDone(f"the film {self._name} could not be written: {cause}", "try again")
            self._errors.seek(0)
            lines = self._errors.read().decode(errors="replace").strip().splitlines()
        cause = lines[-1] if lines else "ffmpeg ended early"
        return NotDone(f"the film {self._name} could not be written: {cause}", "is the disk full?")


class _Gif:
    """Writes a GIF, with one table of colours for all pictures.

    There is no dithering: what does not move takes no room. Pictures stay in memory to the end.
    """

    def __init__(self, path: Path, size: tuple[int, int], fps: float, name: Path) -> None:
        self._path, self._shape, self._ms = path, (size[1], size[0], 3), 1000 / fps
        self._compressed: list[bytes] = []

    def add(self, picture: Picture) -> None:
        self._compressed.append(zlib.compress(picture.tobytes(), 1))

    def _picture(self, number: int) -> Picture:
        return np.frombuffer(zlib.decompress(self._compressed[number]), np.uint8).reshape(
            self._shape
        )

    def finish(self) -> None:
        from PIL import Image

        last = len(self._compressed) - 1
        samples = np.unique(np.linspace(0, last, _SAMPLES).round().astype(int))
        sample = Image.fromarray(np.concatenate([self._picture(number) for number in samples]))
        palette = sample.quantize(
            _COLOURS, method=Image.Quantize.MAXCOVERAGE, kmeans=2, dither=Image.Dither.NONE
        )

        def quantized() -> Iterator[Any]:
            for number in range(last + 1):
                yield Image.fromarray(self._picture(number)).quantize(
                    palette=palette, dither=Image.Dither.NONE
                )

        pictures = quantized()
        next(pictures).save(
            self._path,
            "GIF",
            save_all=True,
            append_images=pictures,
            duration=self._ms,
            loop=0,
            optimize=False,
        )
