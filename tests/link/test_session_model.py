"""Several hosts at one robot, against a model of who may do what.

Leases, heartbeats, kicks, cut links and the time that passes.
"""

from contextlib import contextmanager

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from host.errors import KickctlError
from robot import wire
from robot.record import STATES
from robot.session import Session
from tests.rig import TOKEN, Motor, Rig
from tests.talk import Client

NAMES = ("ann", "bob", "eve")
BABBLE = sorted(set(wire.TYPES) - {wire.STOP})
TRUSTED = ("ann", "bob")
names = st.sampled_from(NAMES)
LINK_LOSS_S = 0.5
CAPACITY = 60


class SessionMachine(RuleBasedStateMachine):
    """ann and bob have the token, eve does not.

    What the model expects is in `state`, `holder`, `taken`, `heard`, `policy`, `kick_end`,
    `kicks`, and in `lost`, by whom somebody has lost the lease.
    """

    def __init__(self):
        super().__init__()
        self.rig = Rig(Motor(turn=0.1), Motor(turn=-0.2), capacity=CAPACITY)
        self.clients = {}
        self.state = "idle"
        self.holder = None
        self.taken = 0.0
        self.lost = {}
        self.heard = 0.0
        self.policy = "stop"
        self.kick_end = 0
        self.kicks = {}
        self.k = 8.0
        self.due = {}

    # What the model knows

    @property
    def tick(self):
        return self.rig.loop.blackbox.next_tick

    @property
    def kicked(self):
        return self.tick < self.kick_end

    def client(self, name):
        if name not in self.clients:
            self.clients[name] = Client(
                self.rig.loop, TOKEN if name in TRUSTED else None, name
            ).greet()
            self.due[name] = None
        return self.clients[name]

    def _enter(self, state):
        self.state = state
        self.kick_end = 0

    @contextmanager
    def _nothing_changes(self):
        """Nothing changes but the time of the holder's latest command, refused or not."""
        before = self.rig.fingerprint()
        yield
        then = self.rig.fingerprint()
        before.pop("lease")
        then.pop("lease")
        assert then == before

    def _tell(self, name, do, allowed, **arguments):
        """The answer if the model allows the command.

        None after it has been refused and has changed nothing.
        """
        client = self.client(name)
        call = client.tell if name in TRUSTED else client.ask
        if name in TRUSTED and name == self.holder:
            self.heard = self.rig.clock.time
        if allowed and name in TRUSTED:
            return call(do, **arguments)
        with self._nothing_changes():
            try:
                call(do, **arguments)
            except KickctlError:
                return None
            raise AssertionError(f"{name} was not refused: {do}")

    # What happens

    @rule(ticks=st.integers(1, 12) | st.just(20))
    def time_passes(self, ticks):
        for _ in range(ticks):
            self.rig.clock.wait(self.rig.loop.deadline, lambda timeout_s: None)
            if self.holder is not None and self.rig.clock.time - self.heard > LINK_LOSS_S:
                self.holder = None
                if self.state == "running" and self.policy != "continue":
                    self._enter({"stop": "stopped", "hold": "held"}[self.policy])
            self.rig.loop.tick()

    def _gain(self, name):
        self.heard = self.rig.clock.time
        if self.holder != name:
            self.taken = self.rig.clock.time
        self.holder = name
        self.lost.pop(name, None)
        if self.state == "held":
            self._enter("running")

    @rule(name=names)
    def lease(self, name):
        if self._tell(name, "lease", self.holder in (None, name)) is not None:
            self._gain(name)

    @rule(name=names)
    def take_over(self, name):
        if self._tell(name, "lease", allowed=True, take_over=True) is not None:
            loser = self.holder if self.holder != name else None
            self._gain(name)
            if loser is not None:
                self.lost = {loser: name}
                reason = f"'{name}' has taken over from '{loser}'"
                event = self.rig.events[-1]
                assert (event["tick"], event["reason"]) == (self.tick, reason)

    @rule(name=names)
    def a_refusal_says_who_drives(self, name):
        if self.holder in (None, name) or name not in TRUSTED:
            return
        try:
            self.client(name).tell("lease")
        except KickctlError as refusal:
            words = "has taken over" if name in self.lost else "has been driven"
            assert f"'{self.holder}'" in refusal.message
            assert words in refusal.message

    @rule(name=names)
    def release(self, name):
        if self._tell(name, "release", allowed=True) is not None and self.holder == name:
            self.holder = None

    @rule(name=names)
    def heartbeat(self, name):
        answer = self._tell(name, "heartbeat", allowed=True)
        assert answer in (None, {"tick": self.tick, "taken_over_by": self.lost.get(name)})

    @rule(name=names)
    def beat(self, name):
        if name not in TRUSTED:
            return
        if name == self.holder:
            self.heard = self.rig.clock.time
        assert self.client(name).beat() == self.lost.get(name)

    @rule(name=names)
    def start(self, name):
        if (
            self._tell(name, "start", self.holder == name and self.state in ("idle", "stopped"))
            is not None
        ):
            self._enter("running")

    @rule(name=names)
    def stop(self, name):
        if self._tell(name, "stop", self.holder == name) is not None and self.state != "fault":
            self._enter("stopped")

    @rule(name=names)
    def stop_frame(self, name):
        assert self.client(name).stop().tick == self.tick
        if self.state != "fault":
            self._enter("stopped")

    @rule()
    def a_stranger_stops(self):
        Session(self.rig.loop, TOKEN, "boot").receive(wire.STOP, b"")
        if self.state != "fault":
            self._enter("stopped")

    @rule(name=names)
    def clear(self, name):
        if self._tell(name, "clear", self.holder == name and self.state == "fault") is not None:
            self._enter("stopped")

    @rule(name=names, number=st.integers(0, 9), ticks=st.integers(1, 6))
    def kick(self, name, number, ticks):
        identity = f"kick {number}"
        known = identity in self.kicks
        allowed = self.holder == name and (known or (self.state == "running" and not self.kicked))
        tick = self.kicks.get(identity, self.tick)
        answer = self._tell(
            name, "kick", allowed, kick={"id": identity, "mode": "position", "ticks": ticks}
        )
        if answer is not None:
            assert answer == {"tick": tick}
            if not known:
                self.kicks[identity] = tick
                self.kick_end = tick + ticks

    @rule(name=names, k=st.sampled_from((1.0, 5.0, -1.0, 200.0)))
    def set_k(self, name, k):
        if (
            self._tell(
                name, "set", self.holder == name and 0.0 <= k <= 100.0, set={"k": k, "a": 4.0}
            )
            is not None
        ):
            self.k = k

    @rule(name=names, policy=st.sampled_from(("stop", "hold", "continue")))
    def set_policy(self, name, policy):
        if self._tell(name, "set", self.holder == name, set={"link_loss": policy}) is not None:
            self.policy = policy

    @rule(name=names)
    def cut(self, name):
        """The link breaks, and the robot does not know."""
        with self._nothing_changes():
            self.clients.pop(name, None)

    @rule(name=names, kind=st.sampled_from(BABBLE), payload=st.binary(max_size=40))
    def babble(self, name, kind, payload):
        """A frame that makes no sense ends the conversation, and nothing else."""
        client = self.client(name)
        with self._nothing_changes():
            client.session.receive(kind, payload)
        # A host with a wrong proof may begin anew.
        assert client.session.closing or (kind == wire.AUTH and not client.session.greeted)
        del self.clients[name]

    @rule(name=names, back=st.integers(0, 2 * CAPACITY))
    def subscribe(self, name, back):
        start = max(0, self.tick - back)
        client = self.client(name)
        client.stream.clear()
        with self._nothing_changes():
            client.ask("subscribe", **{"from": start})
        self.due[name] = start

    @rule(name=names, frames=st.integers(1, 4) | st.just(1000))
    def read(self, name, frames):
        client = self.client(name)
        with self._nothing_changes():
            client.flow(frames)
        for item in client.stream:
            if not isinstance(item, dict):
                assert item.tick == self.due[name], "a gap without a word"
                self.due[name] += 1
            elif item["event"] == "lost":
                assert item["from"] == self.due[name]
                self.due[name] = item["tick"]
        client.stream.clear()
        if frames == 1000 and self.due[name] is not None:
            assert self.due[name] == self.tick

    @precondition(lambda self: self.state != "fault")
    @rule(side=st.sampled_from((0, 1)))
    def a_motor_fails_for_a_tick(self, side):
        self.rig.motors[side].fails = {"read"}
        self.time_passes(1)
        self.rig.motors[side].fails = set()
        self._enter("fault")

    # What must always hold

    @invariant()
    def the_robot_is_as_the_model_says(self):
        loop = self.rig.loop
        assert STATES[loop.safety.state] == self.state
        assert loop.lease.holder == self.holder
        assert loop.params.k == self.k
        assert loop.params.link_loss == self.policy
        assert (loop._kick is not None) == self.kicked

    @invariant()
    def motors_stand_whenever_it_does_not_run(self):
        assert self.state == "running" or self.rig.duties == (0, 0)

    @invariant()
    def a_lost_host_is_noticed_within_two_ticks(self):
        silence = self.rig.clock.time - self.heard
        assert (
            self.rig.loop.lease.holder is None
            or silence <= LINK_LOSS_S + 2 * self.rig.loop.params.tick_s
        )

    @invariant()
    def everybody_sees_the_same_controller(self):
        held_s = None if self.holder is None else self.rig.clock.time - self.taken
        for client in self.clients.values():
            status = client.ask("status")
            assert (status["controller"], status["controller_held_s"]) == (self.holder, held_s)

    @invariant()
    def a_hello_says_who_has_taken_over(self):
        for name in TRUSTED:
            hello = Client(self.rig.loop, TOKEN, name).greet().talk.hello
            assert hello["taken_over_by"] == self.lost.get(name)


TestSessions = SessionMachine.TestCase
TestSessions.settings = settings(max_examples=150, stateful_step_count=40, deadline=None)
