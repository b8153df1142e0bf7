"""A user without a home folder gets words, and no folder named ~, read-only or not."""

import pwd

import pytest


@pytest.fixture
def nobody(kickctl, monkeypatch):
    """kickctl as a user with neither HOME nor an entry in the table of users.

    NUMBA_CACHE_DIR stays: see tests/sim/motor/test_compiled_cache.py for those who have none.
    """

    def getpwuid(uid):
        raise KeyError(uid)

    monkeypatch.setattr(pwd, "getpwuid", getpwuid)
    for name in ("HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME", "KICK_TOKEN"):
        monkeypatch.delenv(name, raising=False)
    return kickctl


@pytest.mark.parametrize(
    ("arguments", "status"),
    [
        (("status",), 0),
        (("doctor",), 0),
        (("kick", "--mode", "membrane", "--seed", "1"), 0),
        (("plan", "--to", "forward", "--seed", "1"), 0),
        (("status", "--brick", "sim://?motor=mine"), 2),
        (("params", "set", "k=2", "--brick", "tcp://127.0.0.1:1"), 3),
    ],
)
def test_every_verb_works_or_says_what_it_needs(nobody, arguments, status):
    done, _, err = nobody(*arguments)
    assert done == status
    assert "Traceback" not in err
    # The last two are matplotlib's, if a fixture is the first to import it.
    expected = {"logs", "token", "cache", "config"}
    assert {path.name for path in nobody.folder.iterdir()} <= expected
