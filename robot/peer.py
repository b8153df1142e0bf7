"""One open link: its bytes in and out, and the conversation over it."""

import errno
import os
import select

from robot import wire
from robot.session import SEE_PROTOCOL

READ_BYTES = 2048
# A peer that does not read gets no more answers once this much waits for it, and is not read from.
FULL_BYTES = 16384
# Its records wait in the black box once this much waits here.
STREAM_BYTES = 8192
_LATER = (errno.EAGAIN, errno.EWOULDBLOCK, errno.EINTR)


class Peer(object):
    """One open link and the conversation over it.

    Args:
        link: Has fileno() and close(), and does not block.
        session: The conversation, a robot.session.Session.
        since: When the link was opened, by the robot's clock (s).
        lasting: Whether it is a serial line, which stays open through noise and silence.
        records_s: How long records may wait for others to be sent with them (s).

    Attributes:
        frame: The frame to answer next, (type, payload), or None.
        out: The bytes to send.
        heard: When the peer sent something last (s).
        moved: When the link took something last, or had nothing to take (s).
        first: Whether it is served before others.
        seated: Whether the peer has one of the robot's places.
        due: Whether it waits for its turn.
        streaming: Whether it gets records in its turn.
        watched: What the server waits for on this link, a mask of select.epoll.
    """

    def __init__(self, link, session, since, lasting, records_s=0.0):
        self.link = link
        self.fd = link.fileno()
        self.session = session
        self.since = self.heard = self.moved = since
        self.lasting = self.first = self.seated = lasting
        self.decoder = wire.Decoder()
        self.frame = None
        self.out = bytearray()
        self.due = self.streaming = False
        self.watched = 0
        self._records_s = records_s
        self._records_due = since

    @property
    def reads(self):
        """Whether more may be read: what came before is answered, and the answers are taken."""
        return self.frame is None and not self.session.closing and len(self.out) < FULL_BYTES

    @property
    def ready(self):
        """Whether its turn would bring it on."""
        return (self.frame is not None and len(self.out) < FULL_BYTES) or (
            self.streaming and not self.out
        )

    def reader(self, now):
        """Whether records are due to it, or an event.

        Args:
            now: The robot's clock (s).
        """
        return self.session.waits(now >= self._records_due)

    def events(self):
        """What to wait for on the link, a mask of select.epoll: what it sends while it may send.

        Also while it waits for its turn to get records, since it may send a stop.
        """
        sends = self.out and not self.due
        return (select.EPOLLIN if self.reads else 0) | (select.EPOLLOUT if sends else 0)

    def read(self, now):
        """Take in what has arrived.

        Args:
            now: The robot's clock (s).

        Returns:
            Whether the link is still open.
        """
        self.heard = now
        try:
            data = os.read(self.fd, READ_BYTES)
        except OSError as error:
            return error.errno in _LATER
        self.decoder.feed(data)
        self.look()
        return bool(data)

    def look(self):
        """Find the next whole frame."""
        if self.frame is not None or self.session.closing:
            return
        self.frame = self.decoder.next()
        if self.decoder.discarded and not self.lasting:
            # TCP delivers what was sent, so this peer does not send frames.
            self.frame = None
            self.refuse("broken", "that was no frame", SEE_PROTOCOL)

    def refuse(self, code, message, hint, **more):
        """End the conversation, and say why."""
        self.out += self.session.refuse(code, message, hint, **more)

    def send(self, now):
        """Send what the link takes now, records too if it is to get any.

        Args:
            now: The robot's clock (s).

        Returns:
            Whether the link is still open.
        """
        if not self.out:
            self.moved = now
        if self.streaming:
            self._records_due = now + self._records_s
        while self.streaming and len(self.out) < STREAM_BYTES:
            frame = self.session.stream()
            if frame is None:
                self.streaming = False
            else:
                self.out += frame
        return self.flush(now)

    def flush(self, now):
        """Send what the link takes now of what waits already.

        Args:
            now: The robot's clock (s).

        Returns:
            Whether the link is still open.
        """
        if self.out:
            try:
                del self.out[: os.write(self.fd, self.out)]
            except OSError as error:
                return error.errno in _LATER
            self.moved = now
        if self.session.closing and not self.out:
            self.session.closing = not self.lasting
            self.look()
            return self.lasting
        return True

    def close(self):
        """Close the link, and obey a stop that came over it and had no turn. All else is dropped.

        Who stops the robot in a hurry may be gone before it is heard.
        """
        try:
            self.decoder.feed(os.read(self.fd, FULL_BYTES))
        except OSError:
            pass
        kind, payload = self.frame or (None, None)
        if kind != wire.STOP:
            payload = self.decoder.find_stop()
        if payload is not None:
            self.session.receive(wire.STOP, payload)
        try:
            self.link.close()
        except OSError:
            pass
