"""What pages have guessed of kicks that are under way, and whether it came true."""

from __future__ import annotations

from typing import Any

from host.kicking.outcome import STOPPED
from host.lab.page_end import Score

# How many kicks may wait for their outcome.
GUESSES_KEPT = 64
Message = dict[str, Any]


class Guesses:
    """The guesses of kicks whose outcome is not known yet, and what the simulation expects."""

    def __init__(self) -> None:
        self._guesses: dict[str, tuple[str | None, Score]] = {}
        self._likeliest: dict[str, dict[str, str]] = {}

    def note(self, kick_id: str, guess: str | None, score: Score) -> None:
        """A page is about to kick.

        Args:
            kick_id: The kick's.
            guess: What the page expects; None if it does not say.
            score: The page's.
        """
        self._guesses[kick_id] = guess, score
        while len(self._guesses) > GUESSES_KEPT:
            oldest = next(iter(self._guesses))
            del self._guesses[oldest]
            self._likeliest.pop(oldest, None)

    def take_prediction(self, prediction: Message) -> None:
        """The simulation has said what it expects of a kick."""
        if prediction["kick_id"] in self._guesses:
            self._likeliest[prediction["kick_id"]] = {
                side: max(shares, key=shares.__getitem__)
                for side, shares in prediction["shares"].items()
            }

    def settle(self, outcome: Message) -> Message:
        """Count who was right about a kick.

        Args:
            outcome: What a station says of it.

        Returns:
            The same with `guess` and `right`.
        """
        guess, score = self._guesses.pop(outcome["kick_id"], (None, None))
        likeliest = self._likeliest.pop(outcome["kick_id"], None)
        right = None
        if guess is not None and score is not None and outcome["result"]:
            right = came_true(dict.fromkeys(outcome["result"], guess), outcome)
            score.guesses += 1
            score.right += right
            if likeliest is not None:
                score.predicted += 1
                score.simulation += came_true(likeliest, outcome)
        return {**outcome, "guess": guess, "right": right}


def came_true(expected: dict[str, str], outcome: Message) -> bool:
    """Whether what was expected is true of each kicked wheel. One at rest has stopped, too."""
    return all(
        expected.get(side) == result
        or (expected.get(side) == "stops" and outcome["after"][side] == STOPPED)
        for side, result in outcome["result"].items()
    )
