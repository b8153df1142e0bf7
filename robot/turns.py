"""Who is served next, and whether there is time for it before the next tick.

A turn answers one frame of a peer and sends what its link takes. Nobody can say in advance how long
that takes, so the turns of late say it.
"""

from collections import deque


class Turns(object):
    """The peers that wait for their turn, in order.

    Some are first: they come before all others, and have a turn in every pause between two ticks,
    also when no turn is short enough to end before the next tick. The others then share one turn in
    every second pause: nobody is forgotten, and delays do not add up.

    Args:
        clock: The robot's clock, see robot.motors.

    Attributes:
        tick: The tick before which this pause is.
        queue: The peers that wait for their turn, in order.
    """

    def __init__(self, clock):
        self.tick = -1
        self._now = clock.now
        self.queue = deque()
        # What turns took lately (s): those that only send, and those that answer a frame.
        self._longest_s = [0.0, 0.0]
        # In which pause others, and the first ones, had their latest turn.
        self._latest = [-2, -2]

    def call(self, peer, again=False):
        """Have a peer wait for a turn.

        Args:
            peer: A robot.peer.Peer.
            again: Whether it has just had one, so that it comes last.
        """
        first = peer.first and not again
        if peer.due:
            if not first:
                return
            self.queue.remove(peer)
        peer.due = True
        if first:
            self.queue.appendleft(peer)
        else:
            self.queue.append(peer)

    def forget(self, peer):
        """Give a peer no turn.

        Args:
            peer: A robot.peer.Peer.
        """
        if peer.due:
            self.queue.remove(peer)

    def next(self, until):
        """Begin the next turn, if there is time.

        Args:
            until: When the next tick is (s).

        Returns:
            The peer that has it, or None.
        """
        if not self.queue or not self._has_time(self.queue[0], until):
            return None
        peer = self.queue.popleft()
        peer.due = False
        self._latest[peer.first] = self.tick
        return peer

    def end(self, answered, took_s):
        """Learn from a turn.

        Args:
            answered: Whether it answered a frame.
            took_s: How long it took (s).
        """
        self._longest_s[answered] = max(took_s, 0.95 * self._longest_s[answered])

    def _has_time(self, peer, until):
        if self.tick - self._latest[peer.first] >= (1 if peer.first else 2):
            return True
        return self._now() + self._longest_s[peer.frame is not None] <= until
