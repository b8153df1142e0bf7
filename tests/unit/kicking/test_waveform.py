"""Waveforms of kicks in files, and what is said about files that hold none."""

import pytest

from host.errors import WrongUse
from host.kicking.waveform import read_waveform


@pytest.mark.parametrize(
    ("text", "param", "expected"),
    [
        ("0.5\n1\n-2e-1\n", "beta", ("beta", [0.5, 1.0, -0.2])),
        ("\ufeffshift_rad\r\n# a push\r\n\r\n1.5\r\n", None, ("shift_rad", [1.5])),
        ("tick,k,note\n0,8,on\n1,2,off\n", None, ("k", [8.0, 2.0])),
        ("k;x1\n8;0.1\n", "x1", ("x1", [0.1])),
    ],
)
def test_a_file_names_its_values_or_the_option_does(tmp_path, text, param, expected):
    path = tmp_path / "push.csv"
    path.write_text(text, encoding="utf-8")
    assert read_waveform(path, param) == expected


@pytest.mark.parametrize(
    ("content", "param", "words"),
    [
        (b"1\n2\n", None, "names no parameter"),
        (b"k,x1\n1,2\n", None, "names more than one parameter"),
        (b"volts\n1\n", "k", "names 'volts', which no kick changes"),
        (b"k\n1\n", "x1", "holds values of k, not of x1"),
        (b"k\n" + b"1\n" * 101, None, "has 101 values"),
        (b"k\n", None, "has 0 values"),
        (b"# nothing\n", None, "is empty"),
        (b"k\n1\n2,5\n", None, "line 3 of .* is '2,5'"),
        (b"1\nnan\n", "k", "line 2 of .* is 'nan'"),
        (b"k,x1\n1\n", "k", "line 2 of .* write 2 cells"),
        (b"\xff\xfe1", "k", "is no text"),
        (b"1" * 1_000_001, "k", "too large"),
    ],
)
def test_a_file_without_a_waveform_is_refused_in_words(tmp_path, content, param, words):
    path = tmp_path / "push.txt"
    path.write_bytes(content)
    with pytest.raises(WrongUse, match=words.partition(" write")[0]) as refused:
        read_waveform(path, param)
    assert refused.value.hint
    assert words.partition(" write")[2] in refused.value.hint


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(WrongUse, match="cannot be read"):
        read_waveform(tmp_path / "none.txt", "k")
