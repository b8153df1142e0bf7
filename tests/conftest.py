"""What holds for every test: hypothesis counts no time, and nothing outside of the test's own folder is touched."""

import pytest
from hypothesis import settings

settings.register_profile("house", deadline=None)
settings.load_profile("house")


@pytest.fixture(autouse=True)
def _own_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("KICK_TOKEN", str(tmp_path / "token"))
    monkeypatch.delenv("KICK_BRICK", raising=False)
