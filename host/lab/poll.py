"""What a class expects of a kick: one question at a time, answered without names.

Answers stay hidden until the kick runs, so that nobody follows the others; then they hold.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from host.errors import NotDone, RefusedByRobot, WrongUse
from host.lab import requests
from host.lab.baton import Baton
from host.lab.guesses import came_true
from host.lab.keys import DRIVE, VIEW
from host.lab.page_end import Page
from host.lab.requests import GUESSES

OPEN, LOCKED, DONE = "open", "locked", "done"
Message = dict[str, Any]


@dataclass
class ClassScore:
    """How often the class was right, in all kicks whose outcome is known.

    Attributes:
        kicks: Questions with at least one answer.
        majority: How many of them the answer of most pages was right in.
        answers: Answers to these questions.
        right: How many of them were right.
    """

    kicks: int = 0
    majority: int = 0
    answers: int = 0
    right: int = 0


@dataclass
class _Question:
    robot: str
    kick: Message
    state: str = OPEN
    kick_id: str = ""
    answers: dict[int, str] = field(default_factory=dict)
    outcome: Message | None = None

    def counts(self) -> dict[str, int]:
        counted = Counter(self.answers.values())
        return {guess: counted[guess] for guess in GUESSES}

    def right(self) -> list[str]:
        """The guesses that are true of each kicked wheel."""
        done = self.outcome
        if done is None or not done["result"]:
            return []
        return [guess for guess in GUESSES if came_true(dict.fromkeys(done["result"], guess), done)]


class Poll:
    """The question that is put to the class, and the answers of its pages.

    Args:
        pages: The pages that have joined, by number.
        baton: Who drives. Pages with the drive key ask; who watches and does not drive answers.

    Attributes:
        changed: Whether pages have to be told.
    """

    def __init__(self, pages: Mapping[int, Page], baton: Baton) -> None:
        self._pages = pages
        self._baton = baton
        self.changed = False
        self._question: _Question | None = None
        self._score = ClassScore()

    def take(self, page: Page, message: Message, robot: str) -> None:
        """Take a `poll` of the teacher about a robot, or an `answer` of another page.

        A pupil who drives neither asks nor answers: the kick is theirs.

        Raises:
            KickctlError: The page may not, or not now.
        """
        guess = requests.guess_of(message)
        if message["type"] == "poll":
            kick = message.get("kick")
            asked = None if kick is None else _Question(robot, requests.kick_of(kick))
            if page.role != DRIVE:
                raise RefusedByRobot(
                    "only a page with the drive key asks the class", "kick, or ask the teacher"
                )
            self._question = asked
        elif page.role == DRIVE or self._baton.driver == page.number:
            raise NotDone(
                "a page that asks the class, or drives, does not answer", "guess under Kick"
            )
        elif self._question is None or self._question.state != OPEN:
            raise NotDone("no question is open: answers count until the kick", "wait for the next")
        elif guess is None:
            raise WrongUse("an answer is missing", f"it is one of {', '.join(GUESSES)}")
        else:
            self._question.answers[page.number] = guess
        self.changed = True

    def lock(self, robot: str, kick: Message, kick_id: str) -> None:
        """A robot is about to be kicked: if the question is about this kick, answers hold now."""
        question = self._question
        if question is None or question.robot != robot:
            return
        if question.state == LOCKED:
            self.settle({"kick_id": question.kick_id, "result": {}, "why": "another kick came"})
        elif question.state == OPEN and question.kick == kick:
            question.state, question.kick_id = LOCKED, kick_id
            self.changed = True

    def unlock(self, kick_id: str) -> None:
        """The robot has refused the kick: the question is open again."""
        question = self._question
        if question is not None and question.state == LOCKED and question.kick_id == kick_id:
            question.state = OPEN
            self.changed = True

    def settle(self, outcome: Message) -> None:
        """The outcome of a kick is known, or that there will be none."""
        question = self._question
        if question is None or question.state != LOCKED or question.kick_id != outcome["kick_id"]:
            return
        question.state, question.outcome = DONE, outcome
        self.changed = True
        counts = question.counts()
        if not (question.answers and outcome["result"]):
            return
        right = question.right()
        most = [guess for guess in GUESSES if counts[guess] == max(counts.values())]
        self._score.kicks += 1
        self._score.majority += len(most) == 1 and most[0] in right
        self._score.answers += len(question.answers)
        self._score.right += sum(counts[guess] for guess in right)

    def tell_if_changed(self) -> None:
        """Tell all pages. It is called ten times a second, and not with each answer of a class."""
        if self.changed:
            self.changed = False
            self.tell(*self._pages.values())

    def tell(self, *pages: Page) -> None:
        """Send pages the `poll` message."""
        question = self._question
        common: Message = {"type": "poll", "state": "none", "score": asdict(self._score)}
        if question is None:
            for page in pages:
                page.send(common)
            return
        driver, done = self._baton.driver, question.outcome or {}
        viewers = {page.number for page in self._pages.values() if page.role == VIEW} - {driver}
        common |= {
            "state": question.state,
            "robot": question.robot,
            "kick": question.kick,
            "answered": len(question.answers),
            "of": len(viewers | question.answers.keys()),
            "counts": None if question.state == OPEN else question.counts(),
            "right": question.right(),
            "outcome": {name: done[name] for name in ("before", "result", "why") if name in done},
        }
        for page in pages:
            page.send({**common, "yours": question.answers.get(page.number)})
