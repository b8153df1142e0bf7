"""Non-blocking links, TCP and serial, served in the time between two ticks and no longer."""

import errno
import os
import select
import socket

from robot import wire
from robot.session import Session, new_id

MAX_PEERS = 8
READ_BYTES = 2048
# Beyond this a peer that does not read is not read from either; its records wait in the black box.
FULL_BYTES = 65536
STREAM_BYTES = 16384
# The kernel's buffer for a peer, which would grow to megabytes by itself.
SEND_BUFFER_BYTES = 65536
GREETING_S = 5.0
LINE_RETRY_S = 1.0
# Nobody pauses for this long within a frame: what looks like the beginning of one was noise.
LINE_SILENCE_S = 0.2
_LATER = (errno.EAGAIN, errno.EWOULDBLOCK, errno.EINTR)


class Peer(object):
    """One open link: its bytes in and out, and the conversation over it.

    Args:
        link: Has fileno() and close(), and does not block.
        session: The conversation, a robot.session.Session.
        since: When the link was opened, by the robot's clock (s).
        lasting: Whether it is a serial line, which stays open through noise and silence.
    """

    def __init__(self, link, session, since, lasting):
        self.link = link
        self.fd = link.fileno()
        self.session = session
        self.since = self.heard = since
        self.lasting = lasting
        self.decoder = wire.Decoder()
        self.out = bytearray()

    def read(self, now):
        """Take in what has arrived.

        Args:
            now: The robot's clock (s).

        Returns:
            Whether the link is still open.
        """
        if self.lasting and not select.select((self.fd,), (), (), 0.0)[0]:
            # Without anything to read a serial line answers with nothing, as it does at its end; a
            # connection says "later".
            if now - self.heard > LINE_SILENCE_S:
                self.decoder.skip()
            return True
        self.heard = now
        try:
            data = os.read(self.fd, READ_BYTES)
        except OSError as error:
            return error.errno in _LATER
        if not self.session.closing:
            self.decoder.feed(data)
        return bool(data)

    def answer(self):
        """Answer one frame if a whole one has arrived.

        Returns:
            Whether there was one.
        """
        if self.session.closing or len(self.out) >= FULL_BYTES:
            return False
        frame = self.decoder.next()
        if self.decoder.discarded and not self.lasting:
            # TCP delivers what was sent, so this peer does not send frames.
            self.out += self.session.refuse(
                "broken", "that was no frame", "see PROTOCOL.md for what the robot understands"
            )
        elif frame is not None:
            self.out += self.session.receive(*frame)
            return True
        return False

    def write(self):
        """Send what the link takes now.

        Returns:
            Whether the link is still open.
        """
        while not self.session.closing and len(self.out) < STREAM_BYTES:
            frame = self.session.stream()
            if frame is None:
                break
            self.out += frame
        if not self.out:
            return True
        try:
            del self.out[: os.write(self.fd, self.out)]
        except OSError as error:
            return error.errno in _LATER
        if self.session.closing and not self.out:
            self.session.closing = not self.lasting
            return self.lasting
        return True


class _Line(object):
    """A serial line to be kept open."""

    def __init__(self, open_line):
        self.open = open_line
        self.peer = None
        self.next_try = 0.0


class Server(object):
    """All links of a robot. The loop's clock calls `serve` while it waits for the next tick.

    Args:
        loop: The robot, a robot.loop.Loop.
        token: The robot's token, 32 bytes.
    """

    def __init__(self, loop, token):
        self.boot = new_id()
        self._loop = loop
        self._token = token
        self._listener = None
        self._peers = []
        self._lines = []

    def listen(self, host, port):
        """Accept TCP connections.

        Args:
            host: The address to listen on; '::' is every address, of IPv4 too.
            port: The port; 0 lets the system choose one.

        Returns:
            The port.

        Raises:
            OSError: The system does not give that port.
        """
        six = ":" in host
        self._listener = socket.socket(socket.AF_INET6 if six else socket.AF_INET)
        self._listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if six:
            self._listener.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 0)
        self._listener.bind((host, port))
        self._listener.listen(128)
        self._listener.setblocking(False)
        return self._listener.getsockname()[1]

    def adopt(self, link, lasting=False):
        """Serve a link that is open already.

        Args:
            link: Has fileno() and close(), and does not block.
            lasting: Whether it is a serial line, which survives noise.

        Returns:
            The Peer at its other end.
        """
        session = Session(self._loop, self._token, self.boot)
        peer = Peer(link, session, self._loop.clock.now(), lasting)
        self._peers.append(peer)
        return peer

    def attach(self, open_line):
        """Serve a serial line, and open it again whenever it breaks.

        Args:
            open_line: Returns the open line, a link as for `adopt`, or raises OSError.
        """
        self._lines.append(_Line(open_line))

    def close(self):
        """Close every link."""
        for peer in list(self._peers):
            self._drop(peer)
        if self._listener is not None:
            self._listener.close()
            self._listener = None

    def serve(self, timeout_s):
        """Answer and send what is due.

        At least one frame of each peer is answered, so that a stop is always heard.

        Args:
            timeout_s: How long to wait for more (s).
        """
        clock = self._loop.clock
        until = clock.now() + timeout_s
        more = self._talk()
        while more and clock.now() <= until:
            more = self._talk()
        if not more and timeout_s > 0.0:
            self._wait(max(0.0, until - clock.now()))

    def _wait(self, timeout_s):
        readers = [peer.fd for peer in self._peers if len(peer.out) < FULL_BYTES]
        writers = [peer.fd for peer in self._peers if peer.out]
        if self._listener is not None:
            readers.append(self._listener.fileno())
        select.select(readers, writers, (), timeout_s)

    def _talk(self):
        """One round over all links. Returns whether more has arrived already."""
        now = self._loop.clock.now()
        more = self._listener is not None and self._accept()
        for line in self._lines:
            self._mend(line)
        for peer in list(self._peers):
            answered = peer.answer()
            alive = True
            if not answered and len(peer.out) < FULL_BYTES:
                alive = peer.read(now)
                answered = peer.answer()
            alive = peer.write() and alive
            more = more or answered
            late = not peer.session.greeted and not peer.lasting and now - peer.since > GREETING_S
            if not alive or late:
                self._drop(peer)
        return more

    def _accept(self):
        """Take in one connection, so that it is heard before the next could push it out.

        Returns whether there was one.
        """
        try:
            link = self._listener.accept()[0]
        except OSError:
            return False
        link.setblocking(False)
        link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        link.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER_BYTES)
        _detect_half_open(link)
        if len(self._peers) >= MAX_PEERS:
            self._make_room()
        self.adopt(link)
        return True

    def _mend(self, line):
        now = self._loop.clock.now()
        if line.peer in self._peers or now < line.next_try:
            return
        line.next_try = now + LINE_RETRY_S
        try:
            line.peer = self.adopt(line.open(), lasting=True)
        except OSError:
            line.peer = None

    def _make_room(self):
        """Drop the oldest peer: first those without the token, last the one that has the lease."""
        holder = self._loop.lease.holder
        candidates = [peer for peer in self._peers if not peer.lasting]
        candidates.sort(
            key=lambda peer: (
                peer.session.trusted,
                holder is not None and peer.session.client == holder,
                peer.since,
            )
        )
        self._drop(candidates[0])

    def _drop(self, peer):
        self._peers.remove(peer)
        try:
            peer.link.close()
        except OSError:
            pass


def _detect_half_open(link):
    """Have the kernel notice within a minute that the other end is gone."""
    link.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    link.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPIDLE, 20)
    link.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPINTVL, 10)
    link.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPCNT, 3)
