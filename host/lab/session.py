"""The lab's session, without any I/O: messages of pages in, messages for pages out.

It knows keys, roles, the baton and the driver's beat. Robots are stations, which carry commands out
by themselves and never make it wait.
"""

from __future__ import annotations

import uuid
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from host.errors import KickctlError, NotDone, RefusedByRobot, WrongUse, quotable
from host.lab import requests
from host.lab.admission import MAX_PAGES, refusal
from host.lab.basin_pictures import BasinPictures
from host.lab.baton import Baton
from host.lab.guesses import Guesses
from host.lab.invitation import invitation
from host.lab.keys import DRIVE, Keys
from host.lab.lessons.marking import Marking
from host.lab.lessons.texts import lessons
from host.lab.page_end import Departed, Page
from host.lab.poll import Poll
from host.lab.presets import describe_presets, describe_primitives
from host.lab.recording import describe_logs, find_log
from host.lab.station import STOP, Station

MAX_STRANGERS = 64
# How long a connection may take to join (s), and how often states are sent at least.
JOIN_S = 5.0
STATE_S = 1.0
Message = dict[str, Any]


class Session:
    """Pages on one side, robots on the other.

    Args:
        keys: The lab's keys.
        stations: The robots.

    Attributes:
        pages: The pages that have joined, by number.
        rings: The records of all robots, then of all twins, by name; in the welcome's order.
        marking: Checks guided exercises.
        view_url: The page's address for who watches; empty before the server listens.
    """

    def __init__(self, keys: Keys, stations: Iterable[Station]) -> None:
        self.pages: dict[int, Page] = {}
        self.stations = {station.name: station for station in stations}
        self.rings = {name: one.ring for name, one in self.stations.items()}
        for station in self.stations.values():
            if station.twin is not None:
                self.rings[station.twin_name] = station.twin.ring
        self.baton = Baton()
        self.view_url = ""
        self._poll = Poll(self.pages, self.baton)
        self.marking = Marking(self.stations)
        self._keys = keys
        self._strangers: list[Page] = []
        self._departed: dict[int, Departed] = {}
        self._numbers = 0
        self._states: dict[str, Message] = {}
        self._states_due = 0.0
        self._counted = (0, 0)
        self._guesses = Guesses()
        self._basins = {
            name: BasinPictures(station, self._tell_basins)
            for name, station in self.stations.items()
        }

    # Connections.

    def arrive(self, now: float, *, local: bool) -> Page:
        """A connection has been opened.

        Args:
            now: The time (s).
            local: Whether it comes from this computer.

        Returns:
            The page at its other end.
        """
        page = Page(now, local)
        self._strangers.append(page)
        if len(self._strangers) > MAX_STRANGERS:
            self._strangers.pop(0).refuse("too many pages come at once", "try again in a moment")
        return page

    def leave(self, page: Page) -> None:
        """A connection is gone. If its page drove, it has a moment to come back."""
        if page in self._strangers:
            self._strangers.remove(page)
        if self.pages.get(page.number) is page:
            del self.pages[page.number]
            self.baton.forget(page.number)
            self._departed[page.number] = page.departed()
            while len(self._departed) > MAX_PAGES:
                del self._departed[next(iter(self._departed))]
        page.closed = True
        self._tell()

    def receive(self, page: Page, text: str, now: float) -> None:
        """Take in a message of a page. It never raises for what a page can send."""
        if page.closed:
            return
        request = None
        try:
            message = requests.parse(text)
            request = requests.request_of(message)
            if message["type"] == "stop" and page.number:
                self._stop(page, message)  # before anything that could be in its way
            elif page.allowance.take(now):
                self._handle(page, message, request, now)
            else:
                raise NotDone("this page sends too much", "wait a moment")
        except KickctlError as error:
            page.answer(request, error)
        self._tell()

    def tick(self, now: float) -> None:
        """Let time pass; to be called about ten times a second."""
        for page in [one for one in self._strangers if now - one.since > JOIN_S]:
            page.refuse("this page has not said its key", requests.RELOAD)
            self._strangers.remove(page)
        if self.baton.expire(now):
            self._abandon()
        if self.baton.driver is not None:
            for station in self.stations.values():
                station.attend()
        due = now >= self._states_due
        if due:
            self._states_due = now + STATE_S
        self.look(every=due)
        self._poll.tell_if_changed()

    def look(self, *, every: bool = False) -> None:
        """Tell pages how the robots are, if that has changed; `every` also if it has not."""
        for name, station in self.stations.items():
            state = station.state()
            before = self._states.get(name)
            self._states[name] = state
            if every or before is None or _without_time(state) != _without_time(before):
                self.broadcast(state)
        self._tell()

    def hear(self, message: Message) -> None:
        """Take in what a station says, and tell all pages."""
        if message["type"] == "outcome":
            self._tell_outcome(message)
        elif message["type"] == "welcome":
            for page in self.pages.values():
                self._greet(page)
        else:
            if message["type"] == "prediction":
                self._guesses.take_prediction(message)
            self.broadcast(message)
        if message["type"] in ("welcome", "event"):
            for name in {page.basins for page in self.pages.values() if page.basins}:
                self._basins[name].follow()

    def _tell_basins(self, message: Message) -> None:
        for page in self.pages.values():
            if page.basins == message["robot"]:
                page.send(message)

    def _tell_outcome(self, outcome: Message) -> None:
        """Tell each page what a kick did, what was guessed, and how often it guessed right."""
        self._poll.settle(outcome)
        told = self._guesses.settle(outcome)
        self.stations[outcome["robot"]].verdicts.append(told)
        for page in self.pages.values():
            page.send({**told, "score": asdict(page.score)})

    def broadcast(self, message: Message) -> None:
        """Send a message to all pages."""
        for page in self.pages.values():
            page.send(message)

    # Messages.

    def _handle(self, page: Page, message: Message, request: int | None, now: float) -> None:
        kind = message["type"]
        if kind == "join":
            self._join(page, message)
        elif not page.number:
            raise WrongUse("this page has not joined yet", requests.RELOAD)
        elif kind == "beat":
            self.baton.beat(page.number, now)
        elif kind in ("ask", "take", "give", "leave"):
            self._pass(kind, page, message, now)
            page.answer(request, {})
        elif kind == "do":
            self._do(page, message, request, now)
        elif kind == "hand":
            self._hand(page, message, now)
        elif kind in ("poll", "answer"):
            robot = self._station(message).name if kind == "poll" else ""
            self._poll.take(page, message, robot)
            page.answer(request, {})
        else:
            self._inform(page, message, request)

    def _inform(self, page: Page, message: Message, request: int | None) -> None:
        """Tell a page what it asks for, now or later."""
        kind = message["type"]
        if kind == "logs":
            page.answer(request, {"logs": describe_logs(self.stations.values())})
        elif kind == "invite":
            page.answer(request, invitation(self.view_url))
        elif kind == "lessons":
            page.answer(request, {"lessons": lessons()})
        elif kind in ("check", "model"):
            self.marking.take(page, message, request)
        elif kind == "predict":
            self._predict(page, message, request)
        elif kind == "basins":
            self._want_basins(page, message)
        else:
            raise WrongUse(f"there is no message '{quotable(kind)}'", requests.RELOAD)

    def _join(self, page: Page, message: Message) -> None:
        if page.number:
            raise WrongUse("this page has joined already", requests.RELOAD)
        key = requests.text_of(message, "key")
        role = self._keys.role(key)
        why_not = refusal(key, role, len(self.pages), local=page.local)
        if why_not is not None:
            page.refuse(*why_not)
        else:
            self._strangers.remove(page)
            self._admit(page, role or "", message.get("resume"))

    def _admit(self, page: Page, role: str, resume: object) -> None:
        before = None
        if isinstance(resume, int):
            before = self._departed.get(resume)
        if before is not None and before.role == role:
            page.resume(self._departed.pop(before.number))
        else:
            self._numbers += 1
            page.number, page.role = self._numbers, role
        self.pages[page.number] = page
        self._greet(page)
        self._counted = (-1, -1)  # the newcomer has to be told, too

    def _greet(self, page: Page) -> None:
        page.places = {name: ring.recent for name, ring in self.rings.items()}
        page.send(
            {
                "type": "welcome",
                "page": page.number,
                "role": page.role,
                "robots": [station.description() for station in self.stations.values()],
                "twins": [one.twin_description() for one in self.stations.values() if one.twin],
                "presets": describe_presets(),
                "primitives": describe_primitives(),
                "lab": self._keys.lab,
                "unattended": {name: one.rule for name, one in self.stations.items()},
            }
        )
        for station in self.stations.values():
            page.send(station.state())
        page.send(self._baton_for(page))
        self._poll.tell(page)

    def _stop(self, page: Page, message: Message) -> None:
        """Stop one robot, or all: also if the page names one that is not there."""
        name = message.get("robot")
        one = self.stations.get(name) if isinstance(name, str) else None
        for station in self.stations.values() if one is None else [one]:
            station.note_asker(page.number)
            station.stop()

    def _pass(self, kind: str, page: Page, message: Message, now: float) -> None:
        """Pass the baton on."""
        if kind == "ask":
            self.baton.ask(page.number, page.role, now)
        elif kind == "take":
            self.baton.take(page.number, page.role, now)
        elif kind == "give":
            self.baton.give(page.number, page.role, requests.whole_of(message, "page"), now)
        else:
            self.baton.leave(page.number)
            self._abandon()

    def _do(self, page: Page, message: Message, request: int | None, now: float) -> None:
        station = self._station(message)
        command = requests.text_of(message, "command")
        fields = message.get("arguments") or {}
        if not isinstance(fields, dict):
            raise WrongUse("the arguments are no object", requests.RELOAD)
        arguments = requests.arguments_of(command, fields, stops=station.rule == STOP)
        guess = requests.guess_of(fields) if command == "kick" else None
        self.baton.need(page.number, page.role, now)
        station.attend()
        if command == "kick":
            kick_id = uuid.uuid4().hex
            self._poll.lock(station.name, arguments, kick_id)
            self._guesses.note(kick_id, guess, page.score)
            arguments = {**arguments, "id": kick_id}

        def answered(result: Message | KickctlError) -> None:
            if command == "kick" and isinstance(result, KickctlError):
                self._poll.unlock(arguments["id"])
            page.answer(request, result)

        station.do(command, arguments, answered)

    def _predict(self, page: Page, message: Message, request: int | None) -> None:
        station, kick = self._station(message), requests.kick_of(message.get("kick"))
        if page.predicts:
            raise NotDone("this page waits for a prediction already", "wait a moment")
        page.predicts = True

        def answered(result: Message | KickctlError) -> None:
            page.predicts = False
            page.answer(request, result)

        station.predict(kick, answered)

    def _want_basins(self, page: Page, message: Message) -> None:
        page.basins = ""
        if message.get("robot") is not None:
            page.basins = self._station(message).name
            pictures = self._basins[page.basins]
            if pictures.latest is not None:
                page.send(pictures.latest)
            pictures.follow()

    def _hand(self, page: Page, message: Message, now: float) -> None:
        station = self._station(message)
        wheel, angle_rad = requests.wheel_of(message), requests.angle_of(message)
        if self.baton.driver != page.number:
            raise RefusedByRobot("only the page that drives may pull a wheel", "ask for the baton")
        if not station.hand_possible:
            raise NotDone(
                f"the wheels of {station.name} cannot be pulled from here",
                "only those of the lab's own simulated robot can",
            )
        self.baton.beat(page.number, now)
        station.hand(wheel, angle_rad)

    def log(self, name: str) -> Path | None:
        """The file of a log that this lab has recorded; None if there is none of this name."""
        return find_log(self.stations.values(), name)

    def may_read(self, key: str, *, local: bool) -> bool:
        """Whether a key opens the logs."""
        role = self._keys.role(key)
        return role is not None and (local or role != DRIVE)

    def _station(self, message: Message) -> Station:
        name = requests.text_of(message, "robot")
        if name in self.rings.keys() - self.stations.keys():
            raise NotDone("a twin does what its robot is asked to", "choose the robot itself")
        if name not in self.stations:
            raise WrongUse(f"there is no robot '{quotable(name)}'", requests.RELOAD)
        return self.stations[name]

    # What all have to know.

    def _abandon(self) -> None:
        for station in self.stations.values():
            station.abandon()

    def _baton_for(self, page: Page) -> Message:
        baton = self.baton
        return {
            "type": "baton",
            "driver": baton.driver,
            "you": baton.driver == page.number,
            "asking": list(baton.asking),
            "why": baton.why,
        }

    def _tell(self) -> None:
        """Tell all pages who drives and how many there are, if that has changed."""
        if self.baton.changed:
            self.baton.changed = False
            for page in self.pages.values():
                page.send(self._baton_for(page))
        driving = int(self.baton.driver in self.pages)
        counted = driving, len(self.pages) - driving
        if counted != self._counted:
            self._counted = counted
            self.broadcast({"type": "pages", "driving": driving, "watching": counted[1]})
            self._poll.changed = True


def _without_time(state: Message) -> Message:
    """A state without what changes all the time."""
    changing = ("since_s", "battery_v", "late", "missed", "overrun")
    return {name: value for name, value in state.items() if name not in changing}
