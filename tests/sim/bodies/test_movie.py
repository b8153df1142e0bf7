"""Films whose writing fails, and films without pictures."""

import numpy as np
import pytest

from host.errors import NotDone
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
