"""What holds for every test: hypothesis counts no time, and nothing outside of the test's own folder is touched."""

import os

import pytest
from hypothesis import HealthCheck, settings

# No clock decides about a test: neither how long an example takes, nor how long it takes to make
# one up on a busy machine. Where changes are judged, the same examples are tried each time;
# elsewhere new ones.
settings.register_profile(
    "house",
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
    derandomize="CI" in os.environ,
)
settings.load_profile("house")

# Compiled functions are named by what went into them, so that tests may share them with each other
# and with everything else.
CACHES = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")  # noqa: PTH111
os.environ.setdefault("NUMBA_CACHE_DIR", CACHES)


@pytest.fixture(autouse=True)
def _own_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("KICK_TOKEN", str(tmp_path / "token"))
    monkeypatch.delenv("KICK_BRICK", raising=False)
