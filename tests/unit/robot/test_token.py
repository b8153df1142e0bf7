"""The token file: made once, for its owner only, and believed only if it is sound."""

import os
import stat

import pytest

from robot.token import TokenError, default_path, load, load_or_make


def test_a_token_is_made_once_and_only_its_owner_may_read_it(tmp_path):
    path = tmp_path / "new" / "folder" / "token"
    secret, new = load_or_make(str(path))
    assert (len(secret), new) == (32, True)
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700
    assert load_or_make(str(path)) == (secret, False)
    assert load(str(path)) == secret
    other, _ = load_or_make(str(tmp_path / "other"))
    assert other != secret


def test_a_loose_umask_makes_no_loose_token(tmp_path):
    before = os.umask(0)
    try:
        load_or_make(str(tmp_path / "token"))
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "token").stat().st_mode) == 0o600


@pytest.mark.parametrize("mode", [0o640, 0o604, 0o660, 0o622, 0o601])
def test_a_token_that_others_can_touch_is_refused(tmp_path, mode):
    path = tmp_path / "token"
    load_or_make(str(path))
    path.chmod(mode)
    with pytest.raises(TokenError, match="chmod 600"):
        load_or_make(str(path))


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\n",
        b"00" * 31,
        b"00" * 33,
        b"0" * 63,
        b"zz" * 32,
        b"\xff\xfe\x00",
        b"00" * 32 + b"\n" + b"00" * 40,
        b"\x00" * 64,
    ],
)
def test_what_is_no_token_is_refused(tmp_path, content):
    path = tmp_path / "token"
    path.write_bytes(content)
    path.chmod(0o600)
    with pytest.raises(TokenError, match=r"holds no token .*; delete it, and a new one is made$"):
        load_or_make(str(path))
    # Who loads it elsewhere has a copy: nobody makes a new one there.
    with pytest.raises(TokenError, match=r"holds no token .*; copy the robot's token file again"):
        load(str(path))
    assert path.read_bytes() == content


def test_a_token_that_a_person_has_typed_is_taken(tmp_path):
    path = tmp_path / "token"
    path.write_text("  " + "Ab" * 32 + "\r\n\n")
    path.chmod(0o600)
    assert load(str(path)) == b"\xab" * 32


def test_paths_that_cannot_be_are_told_in_words(tmp_path):
    (tmp_path / "file").write_text("")
    for path in (tmp_path, tmp_path / "missing", tmp_path / "file" / "token"):
        with pytest.raises(TokenError):
            load(str(path))
    for path in (tmp_path, tmp_path / "file" / "token"):
        with pytest.raises(TokenError):
            load_or_make(str(path))
    with pytest.raises(TokenError):
        load("token\0")


def test_where_the_token_is_kept(tmp_path, monkeypatch):
    assert default_path() == str(tmp_path / "token")
    monkeypatch.delenv("KICK_TOKEN")
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    assert default_path() == str(tmp_path / "config" / "kickctl" / "token")
    monkeypatch.delenv("XDG_CONFIG_HOME")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert default_path() == str(tmp_path / ".config" / "kickctl" / "token")


def test_a_bare_file_name_is_in_the_working_folder(tmp_path):
    secret, _ = load_or_make("token-here")
    assert (tmp_path / "token-here").read_text().strip() == secret.hex()


def test_a_full_card_leaves_no_empty_token_behind(tmp_path, monkeypatch):
    path = tmp_path / "token"
    fdopen = os.fdopen

    def full(handle, mode):
        os.close(handle)
        return fdopen(os.open("/dev/full", os.O_WRONLY), mode)

    monkeypatch.setattr(os, "fdopen", full)
    with pytest.raises(TokenError, match=r"cannot be written: .*No space left"):
        load_or_make(str(path))
    assert not path.exists()
    monkeypatch.undo()
    assert load_or_make(str(path))[1]
