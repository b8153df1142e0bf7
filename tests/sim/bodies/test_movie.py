"""Films whose writing fails, and films without pictures."""

import imageio_ffmpeg
import numpy as np
import pytest

from host.errors import NotDone
from host.films import movie as films
from host.films.movie import Movie

SMALL = (160, 96)


def test_a_full_disk_is_an_error_and_an_empty_film_leaves_no_file(tmp_path):
    full = tmp_path / "full.mp4"
    full.symlink_to("/dev/full")
    picture = np.random.default_rng(1).integers(0, 256, (96, 160, 3), np.uint8)
    with pytest.raises(NotDone, match="could not be written"), Movie(full, SMALL) as movie:
        for _ in range(5):
            movie.add(picture)
    with Movie(tmp_path / "none.mp4", SMALL):
        pass
    assert not (tmp_path / "none.mp4").exists()


@pytest.fixture
def ffmpeg(tmp_path, monkeypatch):
    """Sets the shell script that stands for ffmpeg."""

    def replace(script):
        path = tmp_path / "ffmpeg"
        path.write_text(f"#!/bin/sh\n{script}\n")
        path.chmod(0o755)
        monkeypatch.setattr(imageio_ffmpeg, "get_ffmpeg_exe", lambda: str(path))
        monkeypatch.setattr(films, "PATIENCE_S", 0.2)

    return replace


def film(path, pictures):
    with Movie(path, SMALL) as movie:
        for _ in range(pictures):
            movie.add(np.zeros((96, 160, 3), np.uint8))


@pytest.mark.parametrize("pictures", [1, 10])
def test_an_ffmpeg_that_does_nothing_is_not_waited_for(tmp_path, ffmpeg, pictures):
    ffmpeg("exec sleep 3600")
    with pytest.raises(NotDone, match="did nothing for"):
        film(tmp_path / "film.mp4", pictures)


def test_an_ffmpeg_that_complains_a_lot_is_read_to_the_end(tmp_path, ffmpeg, monkeypatch):
    ffmpeg("head -c 200000 /dev/zero | tr '\\0' '\\n' >&2; echo no room >&2; cat >&2; exit 1")
    monkeypatch.setattr(films, "PATIENCE_S", 60.0)
    with pytest.raises(NotDone, match="could not be written"):
        film(tmp_path / "film.mp4", 10)


def test_an_ffmpeg_that_ends_early_has_written_no_film(tmp_path, ffmpeg):
    ffmpeg("head -c 46080 > /dev/null; echo no room >&2; exit 1")
    with pytest.raises(NotDone, match="no room"):
        film(tmp_path / "film.mp4", 1)
