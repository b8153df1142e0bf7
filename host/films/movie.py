"""Pictures, one after the other, into a film: .mp4 by ffmpeg, or .gif by Pillow."""

from __future__ import annotations

import subprocess
import zlib
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from host.errors import NotDone, WrongUse
from host.util.extras import need

Picture = NDArray[np.uint8]

FPS = 25
# A GIF's colours, and from how many of its pictures they are taken.
_COLOURS, _SAMPLES = 64, 12


class Movie:
    """A film of so many pictures a second, of (width, height) in pixels, both even, within the `with` block.

    However the block is left, the pictures that were added until then make a film that plays.
    Raises WrongUse if the file's name ends on nothing that can be written or no such file can be
    made, and NotDone if it cannot be finished.
    """

    def __init__(self, path: Path, size: tuple[int, int], fps: float = FPS) -> None:
        ways: dict[str, type[_Mp4 | _Gif]] = {".mp4": _Mp4, ".gif": _Gif}
        if path.suffix.lower() not in ways:
            raise WrongUse(
                f"there is no way to write a film into '{path.name}'",
                f"its name should end with {' or '.join(ways)}",
            )
        if path.suffix.lower() == ".mp4":
            need("imageio_ffmpeg", "bodies")
        try:
            with path.open("ab"):
                pass
        except OSError as error:
            raise WrongUse(
                f"the film {path} cannot be written: {error.strerror}",
                "name a file in a folder that there is",
            ) from error
        self.path, self.pictures = path, 0
        self._way, self._size, self._fps = ways[path.suffix.lower()], size, fps
        self._writer: _Mp4 | _Gif | None = None

    def __enter__(self) -> Self:
        return self

    def add(self, picture: Picture) -> None:
        """The next picture, (height, width, 3)."""
        if self._writer is None:
            self._writer = self._way(self.path, self._size, self._fps)
        self._writer.add(np.ascontiguousarray(picture))
        self.pictures += 1

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._writer is not None:
            self._writer.finish()
        elif self.path.stat().st_size == 0:
            self.path.unlink()


class _Mp4:
    """H.264, as every player and browser shows it.

    A signal from the keyboard is for this program, not for ffmpeg.
    """

    def __init__(self, path: Path, size: tuple[int, int], fps: float) -> None:
        from imageio_ffmpeg import get_ffmpeg_exe

        self._path = path
        source = [
            "-f",
            "rawvideo",
            "-pix_fmt",
            "rgb24",
            "-s",
            "{}x{}".format(*size),
            "-r",
            f"{fps:g}",
            "-i",
            "pipe:",
        ]
        film = [
            "-c:v",
            "libx264",
            "-crf",
            "22",
            "-pix_fmt",
            "yuv420p",
            "-movflags",
            "+faststart",
            "-f",
            "mp4",
            "-y",
            str(path.resolve()),
        ]
        self._process = subprocess.Popen(
            [get_ffmpeg_exe(), "-loglevel", "error", *source, *film],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            start_new_session=True,
        )

    def add(self, picture: Picture) -> None:
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(picture.data)
        except BrokenPipeError:
            raise self._failure(self._process.communicate()[1]) from None

    def finish(self) -> None:
        if self._process.poll() is None:
            said = self._process.communicate()[1]
            if self._process.returncode:
                raise self._failure(said)

    def _failure(self, said: bytes) -> NotDone:
        words = said.decode(errors="replace").strip().splitlines()
        return NotDone(
            f"the film {self._path} could not be written:"
            f" {words[-1] if words else 'ffmpeg ended early'}",
            "is the disk full?",
        )


class _Gif:
    """One table of colours for all pictures, without dithering, so that what does not move takes no room. In memory until it ends."""

    def __init__(self, path: Path, size: tuple[int, int], fps: float) -> None:
        self._path, self._shape, self._ms = path, (size[1], size[0], 3), 1000 / fps
        self._packed: list[bytes] = []

    def add(self, picture: Picture) -> None:
        self._packed.append(zlib.compress(picture.tobytes(), 1))

    def _picture(self, number: int) -> Picture:
        return np.frombuffer(zlib.decompress(self._packed[number]), np.uint8).reshape(self._shape)

    def finish(self) -> None:
        from PIL import Image

        chosen = np.unique(np.linspace(0, len(self._packed) - 1, _SAMPLES).round().astype(int))
        sample = Image.fromarray(np.concatenate([self._picture(number) for number in chosen]))
        palette = sample.quantize(
            _COLOURS, method=Image.Quantize.MAXCOVERAGE, kmeans=2, dither=Image.Dither.NONE
        )

        def quantized() -> Iterator[Any]:
            for number in range(len(self._packed)):
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
