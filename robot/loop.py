"""The fixed tick, and what runs in it.

In this order: read the angles, step the neurons under a kick, limit the duties, write them, record.
"""

from collections import deque
from math import cos, isfinite, pi, sin

from robot.bare import Random, bisect_left
from robot.beacon import Beacon
from robot.blackbox import BlackBox
from robot.errors import Refused
from robot.kick_requests import parse
from robot.kicks import DIRECTION_TICKS, MODES, WHEELS
from robot.motors import MotorFault
from robot.params import LONGEST_STEP_TICKS, Params
from robot.power import Power
from robot.safety import FAULT, HELD, RUNNING, STOPPED, Lease, Safety, limit_duty
from robot.wheel import Side, Wheel
from robot.words import person

SHORTEST_STEP_TICKS = 0.1
# Upper edges of the histogram of how late ticks begin, in s; one more bin counts what is beyond.
LATENESS_EDGES_S = (0.0001, 0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05)
BATTERY_TICKS = 300
KICKS_REMEMBERED = 256


def clamp_step(dt_s, tick_s):
    """The time step that the neurons take for a measured time between two ticks.

    Args:
        dt_s: The measured time, s.
        tick_s: The control period, s.

    Returns:
        The same time, but from SHORTEST_STEP_TICKS to LONGEST_STEP_TICKS control periods, s.
    """
    shortest_s, longest_s = SHORTEST_STEP_TICKS * tick_s, LONGEST_STEP_TICKS * tick_s
    if dt_s < shortest_s:
        return shortest_s
    return longest_s if dt_s > longest_s else dt_s


class Loop(object):
    """A robot of two wheels, one tick at a time.

    Args:
        motors: The left and the right robot.motors.Motor.
        battery: A robot.motors.Battery, or None.
        clock: As robot.motors.MonotonicClock.
        seed: Random seed of the neurons' start values.

    Attributes:
        params: The parameters in force, a robot.params.Params.
        safety: The state: running, stopped, held or in fault.
        lease: Who may drive the robot.
        beacon: Whether the robot shows which one it is.
        blackbox: The records and events of the last minutes.
        lateness: How many ticks began how late, by LATENESS_EDGES_S.
        missed: How many deadlines passed without a tick.
        overruns: How many ticks ended after the next deadline.
        clamped: How many time steps were outside of the allowed range, see `clamp_step`.
        real_time, memory_locked: What the kernel grants, see robot.schedule; None: not asked.
        done: Set it to end `run`.
        motor: The model of both motors; empty if they do not say it, or differ.
        unstopped: The wheels whose motor did not obey the latest stop, 'left' and 'right'.
        incurable: Why no fault can be cleared while this program runs; empty if one can.
        epoch: When the loop was made, on the clock, s. Times in records count from here.
        deadline: When the next tick is to begin, on the clock, s.
    """

    def __init__(self, motors, battery, clock, seed):
        self.params = Params()
        self.safety = Safety()
        self.lease = Lease()
        self.beacon = Beacon()
        self.blackbox = BlackBox(self.params.values())
        self.clock = clock
        self.seed = seed
        self.lateness = [0] * (len(LATENESS_EDGES_S) + 1)
        self.missed = self.overruns = self.clamped = 0
        self.real_time = self.memory_locked = None
        self.done = False
        self.incurable, self.unstopped = "", []
        models = {motor.model for motor in motors}
        self.motor = models.pop() if len(models) == 1 else ""
        self._power = Power(battery)
        self._random = Random(seed)
        self._sides = [
            Side(Wheel(name), motor, deque(maxlen=DIRECTION_TICKS + 1))
            for name, motor in zip(WHEELS, motors)
        ]
        self._kick = None
        self._kick_begins = {}
        self._kick_ids = deque()
        self.battery_v = self._power.latest_v
        self.epoch = self._before = self.deadline = clock.now()

    def run(self, serve):
        """Tick until `done`. The motors are stopped however this ends.

        Args:
            serve: Called between ticks with the time that is left, s, to serve links.
        """
        try:
            while not self.done:
                self.clock.wait(self.deadline, serve)
                self.tick()
        finally:
            self._stop_motors()

    def tick(self):
        """One control period."""
        now = self.clock.now()
        params = self.params
        period = params.tick_s
        late_s, missed = self._keep_schedule(now, period)
        tick = self.blackbox.next_tick
        dt_s = now - self._before if tick else period
        self._before = now
        step_s = clamp_step(dt_s, period)
        if step_s != dt_s:
            self.clamped += 1
        if self.lease.expire(now, params.link_loss_s):
            self._lose_link()
        left, right = self._sides
        try:
            left_duty = self._drive(left, params.polarity_left, tick, step_s)
            right_duty = self._drive(right, params.polarity_right, tick, step_s)
            if self.safety.state == FAULT:
                self._stop_motors()  # again, for one that did not obey
        except MotorFault as fault:
            self.fail(str(fault))
            left_duty = right_duty = 0
        kick_code = 0 if self._kick is None else self._kick_code(tick)
        left, right = left.wheel, right.wheel
        self.blackbox.append(
            (now - self.epoch, step_s, late_s, missed, self.safety.state, kick_code)
            + (left.phi, left.x1, left.x2, left.force, left.torque, left_duty)
            + (right.phi, right.x1, right.x2, right.force, right.torque, right_duty)
        )
        if tick % BATTERY_TICKS == 0:
            self._watch_power()
        self.deadline = deadline = self.deadline + params.tick_s
        if self.clock.now() > deadline:
            self.overruns += 1

    def _keep_schedule(self, now, period):
        """How late this tick is, s, and how many deadlines passed without one.

        The grid of deadlines never moves.
        """
        late_s = now - self.deadline
        missed = 0
        if late_s >= period:
            missed = int(late_s // period)
            self.deadline += missed * period
            self.missed += missed
            late_s = now - self.deadline
        self.lateness[bisect_left(LATENESS_EDGES_S, late_s)] += 1
        return late_s, missed if missed < 65535 else 65535

    def _drive(self, side, polarity, tick, dt_s):
        """One wheel's tick, from its angle to its duty cycle in %. Raises MotorFault."""
        wheel, motor = side.wheel, side.motor
        angle = motor.angle_rad()
        try:
            known = isfinite(angle)
        except (TypeError, OverflowError):  # an engineer's own motor
            known = False
        if not known:
            raise MotorFault("the {} motor's angle is no number: {!r}".format(wheel.side, angle))
        wheel.phi = phi = polarity * angle
        side.travel.append(phi)
        if self.safety.state != RUNNING:
            wheel.rest()
            return 0
        params = self.params
        torque = wheel.step(tick, dt_s, params, self._kick)
        duty = limit_duty(params.duty_scale * torque, params.max_duty_pct)
        motor.write_duty(polarity * duty)
        return duty

    def _kick_code(self, tick):
        """The code of the kick that acts, for the record. Forgets a kick that ends now."""
        kick = self._kick
        if not kick.acts_at(tick + 1):
            self._kick = None
        return 1 + MODES.index(kick.mode)

    def _watch_power(self):
        """Read the battery: warn when it is low, stop when it is empty, compensate if wanted."""
        power = self._power
        power.read()
        self.battery_v = power.latest_v
        warning, exhaustion = power.warning(), power.exhaustion()
        if warning:
            self.blackbox.note("battery", reason=warning)
        if exhaustion and self.safety.state in (RUNNING, HELD):
            self.stop(exhaustion)
        scale = (
            power.duty_scale()
            if self.params.battery_compensation == "on"
            else self.params.duty_scale
        )
        if scale != self.params.duty_scale:
            self.set_params({"duty_scale": scale})

    def start(self):
        """Set the neurons to random potentials and run.

        Returns:
            The number of the first tick.

        Raises:
            Refused: The robot's state does not allow it, or the battery is empty.
        """
        self._power.read()
        exhaustion = self._power.exhaustion()
        if exhaustion:
            raise Refused("state", exhaustion, "it would stop at once")
        self.safety.start()
        wheels = [side.wheel for side in self._sides]
        for wheel in wheels:
            remembered = self._random_angle()
            wheel.x1, wheel.x2 = cos(remembered), sin(remembered)
        return self.blackbox.note("start", x=[[wheel.x1, wheel.x2] for wheel in wheels])

    def _random_angle(self):
        return -pi + 2.0 * pi * self._random.random()

    def stop(self, reason):
        """Stop the motors at once. A robot that is stopped already, or in fault, keeps its reason.

        Args:
            reason: Why, in words.

        Returns:
            The number of the next tick.
        """
        self._stop_motors()
        if self.safety.state not in (STOPPED, FAULT):
            self.safety.stop(reason)
            self.blackbox.note("stop", reason=reason)
        return self.blackbox.next_tick

    def fail(self, reason):
        """Stop the motors and latch a fault.

        Args:
            reason: Why, in words.
        """
        self._fail(reason)
        self._stop_motors()

    def clear(self):
        """Leave a fault for the stopped state, once every motor is there.

        Returns:
            The number of the next tick.

        Raises:
            Refused: There is no fault, or it lasts.
        """
        if self.safety.state == FAULT:
            if self.incurable:
                raise Refused(
                    "fault",
                    "the fault stays: " + self.incurable,
                    "restart the robot's program: it cannot repair this itself",
                )
            for side in self._sides:
                try:
                    side.motor.find()
                except MotorFault as fault:
                    raise Refused("fault", "the fault stays: {}".format(fault)) from None
        self.safety.clear()
        return self.blackbox.note("clear")

    def kick(self, request):
        """Begin a kick in the next tick.

        Args:
            request: As robot.kick_requests.parse takes it.

        Returns:
            The number of the kick's first tick; that of the first time if the same id came before.

        Raises:
            Refused: The request is wrong, the robot does not run, or another kick still acts.
        """
        identity = request.get("id")
        known = self._kick_begins.get(identity) if isinstance(identity, str) else None
        if known is not None:
            return known
        tick = self.blackbox.next_tick
        directions = [side.direction() for side in self._sides]
        kick = parse(request, directions, self.params, tick)
        if self.safety.state != RUNNING:
            raise Refused(
                "state",
                "the robot does not run, so it cannot be kicked",
                "start it first: kickctl start",
            )
        if self._kick is not None:
            raise Refused(
                "busy",
                "the {} kick before it still acts, until tick {}".format(
                    self._kick.mode, self._kick.begin + self._kick.ticks
                ),
                "wait until it is over, then kick again",
            )
        self._kick = kick
        self._kick_begins[kick.id] = tick
        self._kick_ids.append(kick.id)
        if len(self._kick_ids) > KICKS_REMEMBERED:
            del self._kick_begins[self._kick_ids.popleft()]
        return self.blackbox.note("kick", kick=kick.as_dict())

    def set_params(self, changes):
        """Change parameters from the next tick on.

        Args:
            changes: New values by the parameters' names.

        Returns:
            The number of the next tick.

        Raises:
            Refused: A value is wrong, or cannot change now. Nothing has changed then.
        """
        checked = self.params.check(changes, at_rest=self.safety.state not in (RUNNING, HELD))
        if "tick_s" in checked and self._kick is not None:
            raise Refused(
                "busy",
                "tick_s cannot change while a kick acts",
                "set it when the kick is over",
            )
        self.params.apply(checked)
        for side in self._sides:
            if "polarity_" + side.wheel.side in checked:
                side.travel.clear()  # angles before and after do not make a direction together
        return self.blackbox.note("params", set=dict(checked))

    def take_lease(self, holder, name, over=False):
        """Give the lease to a client, and resume a held run.

        Args:
            holder: The client.
            name: What to call it in words.
            over: Whether to take it from another client.

        Raises:
            Refused: Another client holds the lease.
        """
        loser = self.lease.take(holder, name, self.clock.now(), over)
        if loser is not None:
            reason = "{} has taken over from {}".format(person(name), person(loser))
            self.blackbox.note("take_over", reason=reason)
        if self.safety.state == HELD:
            self.safety.resume("{} took control".format(person(name)))
            self.blackbox.note("resume")

    def _lose_link(self):
        policy = self.params.link_loss
        who = person(self.lease.name)
        reason = "{} was silent for {:g} s".format(who, self.params.link_loss_s)
        self.blackbox.note("link_loss", policy=policy, reason=reason)
        if self.safety.state != RUNNING:
            return
        if policy == "stop":
            self.stop(reason)
        elif policy == "hold":
            self._stop_motors()
            if self.safety.state == RUNNING:
                self.safety.hold(reason)
                self.blackbox.note("hold", reason=reason)

    def _fail(self, reason):
        """Latch a fault. One that lasts, or follows from the first, is not recorded again."""
        if self.safety.state != FAULT:
            self.safety.fault(reason)
            self.blackbox.note("fault", reason=self.safety.reason)

    def _stop_motors(self):
        """Stop every motor, also if another one does not obey; `unstopped` says which did not."""
        self._kick = None
        broken, self.unstopped = None, []
        for side in self._sides:
            side.wheel.rest()
            try:
                side.motor.stop()
            except MotorFault as fault:
                self.unstopped += [] if fault.absent else [side.wheel.side]
                self._fail(str(fault))
            except (Exception, SystemExit) as error:  # noqa: BLE001 - the other motor has to stop too
                broken = error
        if broken is not None:
            raise broken
