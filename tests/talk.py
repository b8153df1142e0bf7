"""A host that talks to a robot on a rig, over a link without a network."""

from host.client.conversation import Conversation
from robot import wire
from robot.session import Session
from tests.rig import TOKEN


class Client:
    """A host's conversation with one session of the robot, both without any I/O.

    `stream` collects what a subscription brought.
    """

    def __init__(self, loop, token=TOKEN, name="tester", client=None):
        self.session = Session(loop, TOKEN, "boot")
        self.talk = Conversation(token, name, client or name)
        self.stream = []
        self.talk.begin()

    def greet(self):
        """Say hello, and prove the token if there is one. Returns self."""
        self.give(self.talk.hello_frame())
        if self.talk.token is not None:
            self.give(self.talk.auth_frame())
        return self

    def give(self, data):
        """Hand bytes to the robot, and its answers back."""
        decoder = wire.Decoder()
        decoder.feed(data)
        for frame in iter(decoder.next, None):
            self._take(self.session.receive(*frame))

    def ask(self, do, **arguments):
        """The result of a request; raises what the robot refuses as KickctlError."""
        return self._exchange(*self.talk.request(do, arguments, sealed=False))

    def tell(self, do, **arguments):
        """The result of a sealed command."""
        return self._exchange(*self.talk.request(do, arguments, sealed=True))

    def beat(self):
        """Show the robot that this host is alive. Returns who has taken over from it."""
        self.give(self.talk.beat())
        return self.talk.taken_over_by

    def stop(self):
        """The result of a stop frame."""
        self.give(wire.encode(wire.STOP, b""))
        return self.talk.stopped

    def flow(self, frames=1000000):
        """Take up to `frames` frames of the subscription."""
        for _ in range(frames):
            frame = self.session.stream()
            if frame is None:
                break
            self._take(frame)

    @property
    def records(self):
        return [item for item in self.stream if not isinstance(item, dict)]

    @property
    def events(self):
        return [item for item in self.stream if isinstance(item, dict)]

    def _exchange(self, number, frame):
        self.give(frame)
        result = self.talk.answer(number)
        assert result is not None, "no answer"
        return result

    def _take(self, data):
        for item in self.talk.feed(data):
            self.stream += [item] if isinstance(item, dict) else item.records
