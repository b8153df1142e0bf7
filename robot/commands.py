"""The table of the robot's commands: what anyone may ask, and what the host with the lease may."""

from collections import OrderedDict
from functools import lru_cache
from operator import attrgetter
from types import SimpleNamespace

from robot import params, record, wire
from robot.errors import Refused
from robot.loop import LATENESS_EDGES_S
from robot.words import person

# What the status says of the loop that seldom changes.
_OF_LOOP = ("battery_v", "missed", "overruns", "clamped", "real_time", "memory_locked")
_TAKE_OF_LOOP = attrgetter(*_OF_LOOP)
# The part of the status that says how punctual ticks are, as JSON without the counts.
_LATENESS = b'{"lateness":{"edges_s":%s,"counts":%%s}}' % wire.dump(LATENESS_EDGES_S)


@lru_cache(maxsize=1)
def _params(values):
    return wire.dump({"params": OrderedDict(zip(params.TABLE, values))})


@lru_cache(maxsize=1)
def _seldom_new(state, reason, controller, of_loop, values):
    """The part of the status that seldom changes, as JSON: bytes."""
    facts = dict(zip(_OF_LOOP, of_loop), state=state, reason=reason, controller=controller)
    return wire.join(wire.dump(facts), _params(values))


def _status(loop, session, message):
    safety, lease, now = loop.safety, loop.lease, loop.clock.now()
    often_new = {
        "tick": loop.blackbox.next_tick,
        "clock_s": now - loop.epoch,
        "oldest_tick": loop.blackbox.oldest_tick,
        "controller_held_s": lease.held_s(now),
    }
    seldom_new = _seldom_new(
        record.STATES[safety.state],
        safety.reason,
        None if lease.holder is None else lease.name,
        _TAKE_OF_LOOP(loop),
        params.IN_FORCE(loop.params),
    )
    status = wire.join(wire.dump(often_new), _LATENESS % wire.dump(loop.lateness))
    return wire.join(status, seldom_new)


def _describe(loop, session, message):
    tables = {"params": params.describe, "channels": record.describe, "commands": describe}
    table = message.get("table")
    if not isinstance(table, str) or table not in tables:
        raise Refused(
            "usage",
            "there is no table {!r}".format(table),
            "tables are: " + ", ".join(sorted(tables)),
        )
    return {"table": tables[table]()}


def _subscribe(loop, session, message):
    tick = message.get("from")
    if tick is not None and (
        isinstance(tick, bool)
        or not isinstance(tick, int)
        or not 0 <= tick <= loop.blackbox.next_tick
    ):
        raise Refused(
            "range",
            "cannot send records from tick {!r}".format(tick),
            "ticks 0 to {} have begun".format(loop.blackbox.next_tick),
        )
    return {"tick": session.subscribe(loop.blackbox.next_tick if tick is None else tick)}


def _unsubscribe(loop, session, message):
    session.unsubscribe()
    return {}


def _identify(loop, session, message):
    left_s = loop.beacon.begin(person(session.name), loop.clock.now())
    return {"seconds": left_s, "ways": loop.beacon.ways}


def _lease(loop, session, message):
    loop.take_lease(session.client, session.name, over=_flag(message, "take_over"))
    return {}


def _flag(message, name):
    flag = message.get(name, False)
    if not isinstance(flag, bool):
        raise Refused("usage", "{} cannot be {!r}".format(name, flag), "it is true or false")
    return flag


def _release(loop, session, message):
    loop.lease.release(session.client)
    return {}


def _heartbeat(loop, session, message):
    by = loop.lease.taken_over_by(session.client)
    return {"tick": loop.blackbox.next_tick, "taken_over_by": by}


def _controlled(run):
    """The command `run`, for the host that holds the lease only."""

    def checked(loop, session, message):
        loop.lease.require(session.client, loop.clock.now())
        return run(loop, session, message)

    return checked


def _start(loop, session, message):
    return {"tick": loop.start()}


def _stop(loop, session, message):
    return {"tick": loop.stop(person(session.name) + " stopped it")}


def _clear(loop, session, message):
    return {"tick": loop.clear()}


def _kick(loop, session, message):
    request = message.get("kick")
    if not isinstance(request, dict):
        raise Refused("usage", "the kick is missing", "send it as an object named kick")
    tick = loop.kick(request)
    return {"tick": tick}


def _set(loop, session, message):
    return {"tick": loop.set_params(message.get("set"))}


# Not a namedtuple, see robot/params.py.
def _row(name, sealed, arguments, doc, run):
    return SimpleNamespace(name=name, sealed=sealed, arguments=arguments, doc=doc, run=run)


_ROWS = (
    _row(
        "status",
        False,
        (),
        "state, parameters in force, battery, who controls, and how punctual the ticks are",
        _status,
    ),
    _row(
        "describe",
        False,
        ("table",),
        "one of the robot's tables: params, channels, commands",
        _describe,
    ),
    _row(
        "subscribe",
        False,
        ("from",),
        "send records and events from a tick on, by default from the next",
        _subscribe,
    ),
    _row("unsubscribe", False, (), "send no more records", _unsubscribe),
    _row(
        "identify", False, (), "show which robot this is for 3 s: blink, beep, or say it", _identify
    ),
    _row(
        "lease",
        True,
        ("take_over",),
        "take control; refused while another host has it, unless take_over is true",
        _lease,
    ),
    _row("release", True, (), "give control back; the robot goes on as it is", _release),
    _row(
        "heartbeat",
        True,
        (),
        "show the robot that the host that controls it is alive; says who has taken over from it",
        _heartbeat,
    ),
    _row("start", True, (), "run, from random membrane potentials", _controlled(_start)),
    _row(
        "stop", True, (), "stop the motors; anyone may also send a stop frame", _controlled(_stop)
    ),
    _row("clear", True, (), "leave a fault once its cause is mended", _controlled(_clear)),
    _row(
        "kick",
        True,
        ("kick",),
        "begin a kick in the next tick; a repeated id is answered, not repeated",
        _controlled(_kick),
    ),
    _row(
        "set",
        True,
        ("set",),
        "change parameters from the next tick on, all of them or none",
        _controlled(_set),
    ),
)
TABLE = OrderedDict((row.name, row) for row in _ROWS)


def describe():
    """The table as it goes over the wire.

    Returns:
        A list of dictionaries: name, sealed, arguments, doc.
    """
    keys = ("name", "sealed", "arguments", "doc")
    return [OrderedDict((key, getattr(row, key)) for key in keys) for row in _ROWS]


def execute(loop, session, message, sealed):
    """Carry out a command.

    Args:
        loop: The robot, a robot.loop.Loop.
        session: The peer's conversation.
        message: The request: `do` names the command, its arguments stand beside it.
        sealed: Whether the request came with a valid MAC.

    Returns:
        The result as JSON, bytes.

    Raises:
        Refused: Nothing was done, and nothing has changed.
    """
    name = message.get("do")
    row = TABLE.get(name) if isinstance(name, str) else None
    if row is None:
        raise Refused(
            "unknown", "there is no command {!r}".format(name), "commands are: " + ", ".join(TABLE)
        )
    if row.sealed and not sealed:
        raise Refused(
            "token",
            "'{}' moves the robot or changes it".format(name),
            "prove that you have the robot's token first",
        )
    for key in message:
        if key not in {"id", "do"} and key not in row.arguments:
            raise Refused(
                "usage",
                "'{}' takes no '{}'".format(name, key),
                "it takes " + (", ".join(row.arguments) or "nothing"),
            )
    result = row.run(loop, session, message)
    return result if isinstance(result, bytes) else wire.dump(result)
