"""A robot on a rig: motors that do what the test says, time that passes when the test says."""

from collections import deque

from robot import motors, wire
from robot.blackbox import BlackBox
from robot.loop import Loop
from robot.motors import MotorFault
from robot.record import STRUCT, unpack

TOKEN = bytes(range(wire.TOKEN_BYTES))


class Clock:
    """Virtual time. Each wait ends at its deadline, or as much later as `lates` says next."""

    def __init__(self, lates=()):
        self.time = 0.0
        self.lates = deque(lates)

    def now(self):
        return self.time

    def wait(self, deadline, serve):
        serve(0.0)
        self.time = max(self.time, deadline) + (self.lates.popleft() if self.lates else 0.0)


class BusyClock(Clock):
    """Time passes with the work that is done, and by itself where there is none."""

    def wait(self, deadline, serve):
        while self.time < deadline:
            before = self.time
            serve(deadline - before)
            if self.time == before:
                self.time = deadline
        serve(0.0)


class Motor(motors.Motor):
    """Turns by `turn` rad with every reading, whatever its duty; fails at whatever `fails` names.

    Read, write, stop.
    """

    def __init__(self, angle=0.0, turn=0.0):
        self.angle = angle - turn
        self.turn = turn
        self.duty = 0
        self.done = []
        self.fails = set()

    def _do(self, what):
        self.done.append(what)
        if what in self.fails:
            raise MotorFault("cannot " + what)

    def angle_rad(self):
        self._do("read")
        self.angle += self.turn
        return self.angle

    def write_duty(self, duty_pct):
        assert type(duty_pct) is int
        assert -100 <= duty_pct <= 100
        self._do("write")
        self.duty = duty_pct

    def stop(self):
        self._do("stop")
        self.duty = 0


class Rig:
    """The loop and its parts."""

    def __init__(self, left=None, right=None, lates=(), seed=1, capacity=None, battery=None):
        self.motors = (left or Motor(), right or Motor())
        self.clock = Clock(lates)
        self.loop = Loop(self.motors, battery, self.clock, seed)
        if capacity is not None:
            self.loop.blackbox = BlackBox(self.loop.params.values(), capacity)
        self.served = []

    def run(self, ticks=1):
        """Let the loop's own `run` do some ticks, without stopping the motors at its end."""
        for _ in range(ticks):
            self.clock.wait(self.loop.deadline, self.served.append)
            self.loop.tick()

    @property
    def duties(self):
        return tuple(motor.duty for motor in self.motors)

    @property
    def records(self):
        """Everything that the black box still has."""
        box = self.loop.blackbox
        return [
            unpack(box.read(tick, 1))[0] for tick in range(max(0, box.oldest_tick), box.next_tick)
        ]

    @property
    def last(self):
        return self.records_from(self.loop.blackbox.next_tick - 1)[0]

    def records_from(self, tick):
        box = self.loop.blackbox
        return [unpack(box.read(number, 1))[0] for number in range(tick, box.next_tick)]

    @property
    def events(self):
        """What the journal still has."""
        return [event for _, event in self.loop.blackbox._journal]

    def fingerprint(self):
        """Everything about the robot that a request could change: two are equal if nothing was."""
        loop = self.loop
        box = loop.blackbox
        return {
            "params": dict(loop.params.values()),
            "safety": (loop.safety.state, loop.safety.reason),
            "lease": dict(vars(loop.lease)),
            "wheels": [
                (wheel.x1, wheel.x2, wheel.force, wheel.torque)
                for wheel in [side.wheel for side in loop._sides]
            ],
            "kick": loop._kick and loop._kick.as_dict(),
            "kicks": (dict(loop._kick_begins), list(loop._kick_ids)),
            "motors": [(motor.duty, len(motor.done)) for motor in self.motors],
            "box": (
                box.next_tick,
                box.next_event,
                box.oldest_tick,
                len(box._journal),
                bytes(box._ring),
            ),
            "counts": (loop.missed, loop.overruns, loop.clamped, list(loop.lateness)),
            "random": loop._random.getstate(),
            "time": (loop.deadline, loop._before, loop.done),
        }


def whole(data):
    """The frames in bytes that hold nothing else."""
    decoder = wire.Decoder()
    decoder.feed(data)
    frames = list(iter(decoder.next, None))
    assert decoder.discarded == 0
    return frames


def packed(records):
    """Records as bytes, for a comparison of every bit."""
    return b"".join(STRUCT.pack(*record) for record in records)


PERIOD = 0.03  # of a rig whose tick_s nobody has changed


def running(**parts):
    """A rig whose loop runs."""
    rig = Rig(**parts)
    rig.loop.start()
    return rig


def kicked(rig, mode="position", **details):
    """Kick a rig's loop, by an id of its own. Returns the tick."""
    rig.number = getattr(rig, "number", 0) + 1
    return rig.loop.kick(dict(details, id=str(rig.number), mode=mode))
