"""Stand-ins that make a real robot.loop.Loop run anywhere, the same each time.

A clock, motors, and the log of what happened.
"""

from itertools import cycle
from math import pi

from host.logs.log import Log
from robot import wire
from robot.loop import Loop
from robot.motors import Motor, MotorFault
from robot.record import unpack
from robot.session import Session

# How late ticks begin, over and over; one so late that a deadline passes, one that delta t is cut
# off.
LATENESS_S = (
    (0.0, 0.0004, 0.0011, 0.0, 0.0003, 0.0062, 0.0009) * 3
    + (0.0412,)
    + (0.0002, 0.0005) * 8
    + (0.11,)
)

KICKS = (
    {"mode": "membrane"},
    {"mode": "position", "ticks": 3},
    {"mode": "phase", "ticks": 4},
    {"mode": "phase", "ticks": 4, "shift": -0.5},
    {"mode": "jump", "variable": "x2", "delta": 0.7},
    {"mode": "jump", "variable": "x1", "delta": -2.0},
    {"mode": "waveform", "param": "beta", "waveform": [0.4, 1.0, 0.4]},
    *(
        {"mode": "pulse", "ticks": 6, "shape": "smooth", "param": name, "value": value}
        for name, value in (("a", 0.5), ("tau_s", 2.0))
    ),
    *(
        {"mode": "pulse", "ticks": 5, "param": name, "value": value}
        for name, value in (("k", 0.0), ("beta", 0.8), ("shift_rad", 2.0))
    ),
)


class FakeClock:
    """Virtual time that is late for its deadlines by the given times (s), over and over."""

    def __init__(self, lateness=LATENESS_S):
        self.time = 100.0
        self._lateness = cycle(lateness)

    def now(self):
        return self.time

    def wait(self, deadline, serve):
        serve(0.0)
        self.time = max(self.time, deadline) + next(self._lateness)


class FakeMotor(Motor):
    """A wheel with a speed of 0.18 rad/s for each percent of duty, after 80 ms; in whole degrees.

    `fails` names the method that raises MotorFault from now on.
    """

    def __init__(self, clock, angle):
        self.fails = None
        self._clock = clock
        self._angle = angle
        self._speed = 0.0
        self._duty = 0
        self._then = clock.now()

    def _check(self, method):
        if self.fails == method:
            raise MotorFault("the cable is out: plug it in")
        while self._then < self._clock.now() - 1e-9:
            step = min(0.001, self._clock.now() - self._then)
            self._speed += (0.18 * self._duty - self._speed) * step / 0.08
            self._angle += self._speed * step
            self._then += step

    def angle_rad(self):
        self._check("angle_rad")
        return round(self._angle * 180 / pi) * pi / 180

    def write_duty(self, duty_pct):
        self._check("write_duty")
        self._duty = duty_pct

    def stop(self):
        self._check("stop")
        self._duty = 0


class Rig:
    """A robot with fake motors: `loop`, `motors`, `clock`."""

    def __init__(self, seed=1, lateness=LATENESS_S):
        self.clock = FakeClock(lateness)
        self.motors = (FakeMotor(self.clock, 0.3), FakeMotor(self.clock, -1.1))
        self.loop = Loop(self.motors, None, self.clock, seed)
        self._kicks = 0

    def run(self, ticks):
        for _ in range(ticks):
            self.clock.wait(self.loop.deadline, lambda timeout_s: None)
            self.loop.tick()

    def kick(self, mode, **details):
        self._kicks += 1
        return self.loop.kick(dict(details, mode=mode, id=str(self._kicks)))

    def feed(self, tap, tick=0):
        """Give a tap everything from `tick` on, over the wire's bytes as a session sends it."""
        session, decoder = Session(self.loop, b"", "boot"), wire.Decoder()
        session.subscribe(tick)
        for frame in iter(session.stream, None):
            decoder.feed(frame)
            kind, payload = decoder.next()
            if kind == wire.EVENT:
                tap.take_event(wire.load(payload))
            else:
                tap.take_records(unpack(wire.open_samples(payload)[1]))

    def log(self, tick=0, **info):
        log = Log(info)
        self.feed(log, tick)
        return log


def eventful():
    """A rig to which everything happened that changes the course of a robot."""
    rig = Rig()
    loop = rig.loop
    rig.run(4)
    loop.set_params({"polarity_right": -1})
    loop.start()
    rig.run(40)
    for wheel in ("left", "right", "both"):
        for details in KICKS:
            begin = rig.kick(wheel=wheel, **details)
            rig.run(loop.blackbox.next_tick - begin + details.get("ticks", 4) + 3)
    for changes in (
        {"k": 3.3},
        {"a": 5.5, "tau_s": 0.31},
        {"rods": 1},
        {"rods": 2, "max_duty_pct": 47.5},
        {"rod_lag_s": 0.0125},
        {"tick_s": 0.04},
    ):
        loop.set_params(changes)
        rig.run(15)
    rig.kick("phase", ticks=20)
    rig.run(5)
    loop.stop("enough")
    rig.run(5)
    loop.start()
    rig.run(30)
    loop.set_params({"link_loss": "hold"})
    loop.take_lease("a", "host")
    rig.kick("position", ticks=300)
    rig.run(20)
    loop.take_lease("a", "host")
    loop.lease.release("a")
    rig.run(5)
    rig.motors[1].fails = "angle_rad"
    rig.run(3)
    rig.motors[1].fails = None
    loop.clear()
    rig.run(2)
    loop.start()
    rig.run(10)
    rig.motors[0].fails = "stop"
    loop.stop("again")
    rig.run(2)
    return rig
