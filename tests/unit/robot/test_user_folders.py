"""Users without a home folder have no files of their own, and no folder named ~ appears."""

import pwd

import pytest

from robot.token import TokenError, default_path, load, load_or_make
from robot.user_folders import cache_folder, config_folder


@pytest.fixture
def nobody(monkeypatch, tmp_path):
    """A user with neither HOME nor an entry in the table of users."""

    def getpwuid(uid):
        raise KeyError(uid)

    monkeypatch.setattr(pwd, "getpwuid", getpwuid)
    for name in ("HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME", "KICK_TOKEN"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.chdir(tmp_path)


def test_folders_lie_where_the_user_says(monkeypatch):
    monkeypatch.setenv("HOME", "/home/me")
    for name, folder in (("XDG_CONFIG_HOME", config_folder), ("XDG_CACHE_HOME", cache_folder)):
        monkeypatch.setenv(name, "/else")
        assert folder() == "/else/kickctl"
        for no_place in ("", "relative"):
            monkeypatch.setenv(name, no_place)
            assert folder().startswith("/home/me/.c")


def test_who_has_no_home_has_no_folders(nobody):
    assert (config_folder(), cache_folder(), default_path()) == ("", "", "")


@pytest.mark.parametrize("use", [load, load_or_make])
def test_who_has_no_home_is_asked_to_name_the_token(nobody, tmp_path, use):
    with pytest.raises(TokenError, match="KICK_TOKEN"):
        use(default_path())
    assert list(tmp_path.iterdir()) == []


def test_a_home_that_is_no_place_counts_as_none(nobody, monkeypatch):
    monkeypatch.setenv("HOME", "relative")
    assert config_folder() == ""
