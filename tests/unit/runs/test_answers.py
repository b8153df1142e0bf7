"""The table of results: digits by the error, words as they are, none where there is nothing."""

import pytest

from host.runs.answers import Answer, as_data, lines


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (Answer("a", 0.86991, 0.00402, "/s"), "0.8699 ± 0.0040 /s"),
        (Answer("a", -14.2, 0.31), "-14.20 ± 0.31"),
        (Answer("a", 4832.1, 25.0), "4832 ± 25"),
        (Answer("a", 1.77731184665692), "1.77731185"),
        (Answer("a", 33.25, None, "%"), "33.25 %"),
        (Answer("a", -3.3e-9, 2.4e-6, "/s"), "0 ± 0.0000024 /s"),
        (Answer("a", -5.26315789473684159, 3.3e-16), "-5.26315789 ± 3e-16"),
        (Answer("a", "chaotic"), "chaotic"),
        (Answer("a", None), "none"),
    ],
)
def test_an_answer_has_the_digits_that_its_error_leaves(answer, words):
    assert answer.in_words() == words


def test_names_and_values_stand_in_columns():
    table = list(lines(as_data([Answer("k", 1.5), Answer("tau", 0.25, None, "s")])))
    assert table == ["  k    1.5", "  tau  0.25 s"]
