"""Non-blocking links, TCP and serial, served in the time between two ticks and no longer.

Who controls the robot comes first, then all others by turns. A stop waits for nobody's turn.
"""

import select
import time
from types import SimpleNamespace

from robot import schedule, wire
from robot.bare import socket
from robot.peer import Peer
from robot.safety import HELD, RUNNING
from robot.session import Session, new_id
from robot.turns import Turns

# Hosts that are served at once; more of them if they prove the token, so that watchers lock nobody
# out; and connections on which no host has said who it is.
PLACES = 64
SPARE_PLACES = 8
STRANGERS = 64
# How many hosts get records in each tick, beside the one that controls. The others get more at a
# time, and the robot's work does not grow with them.
STREAMS_PER_TICK = 6
# The kernel's buffers for a connection, which would grow to megabytes by themselves.
SEND_BUFFER_BYTES = 16384
RECEIVE_BUFFER_BYTES = 8192
# How long a connection may take to get a place, and a host to read anything of what waits for it.
GREETING_S = 5.0
DEAF_S = 60.0
SWEEP_S = 0.5
# For how long nobody is heard while others have their turns, unless one turn takes longer.
HEAR_S = 0.001
# For how long all are heard, or hung up on, although the next tick is due, unless one takes longer.
HEARING_S = 0.005
# When a host that found no place may come again.
RETRY_S = 60
LINE_RETRY_S = 1.0
# Nobody pauses for this long within a frame: what looks like the beginning of one was noise.
LINE_SILENCE_S = 0.2
_LOST = select.EPOLLHUP | select.EPOLLERR


class Server(object):
    """All links of a robot. The loop's clock calls `serve` while it waits for the next tick.

    Args:
        loop: The robot, a robot.loop.Loop.
        token: The robot's token, 32 bytes.
        records_s: How long records may wait for others to be sent with them (s). Events, and what
            a host asks for, do not wait.
    """

    def __init__(self, loop, token, records_s=0.0):
        self._records_s = records_s
        self.boot = new_id()
        self._loop = loop
        self._now = loop.clock.now
        self._token = token
        self._listener = None
        self._poll = select.epoll()
        self._peers = []
        self._by_fd = {}
        self._lines = []
        self._driver = None  # the peer that sent the latest command of the host with the lease
        self._turns = Turns(loop.clock)
        self._place = 0  # in the list of peers: who was chosen last to get records
        self._sweep_due = 0.0

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
        _limit(self._listener)
        self._listener.listen(128)
        self._listener.setblocking(False)
        self._poll.register(self._listener, select.EPOLLIN)
        return self._listener.getsockname()[1]

    @property
    def everywhere(self):
        """Whether the server listens on every address of this machine."""
        host = self._listener.getsockname()[0]
        return host in ("0.0.0.0", "::", "::ffff:0.0.0.0")  # noqa: S104

    def adopt(self, link, lasting=False):
        """Serve a link that is open already.

        Args:
            link: Has fileno() and close(), and does not block.
            lasting: Whether it is a serial line, which survives noise.

        Returns:
            The Peer at its other end.
        """
        session = Session(self._loop, self._token, self.boot)
        peer = Peer(link, session, self._now(), lasting, self._records_s)
        self._peers.append(peer)
        self._by_fd[peer.fd] = peer
        self._poll.register(peer.fd, peer.events())
        peer.watched = peer.events()
        return peer

    def attach(self, open_line):
        """Serve a serial line, and open it again whenever it breaks.

        Args:
            open_line: Returns the open line, a link as for `adopt`, or raises OSError.
        """
        self._lines.append(SimpleNamespace(open=open_line, peer=None, next_try=0.0))

    def close(self):
        """Send everybody what is left, as far as the links take it, and close them."""
        for peer in list(self._peers):
            peer.streaming = True
            peer.send(self._now())
            self._drop(peer)
        if self._listener is not None:
            self._listener.close()
            self._listener = None
        self._poll.close()

    def serve(self, timeout_s):
        """Answer and send what is due. What does not fit into the time waits for the next call.

        Args:
            timeout_s: How long it is until the next tick (s).
        """
        now = self._now()
        loop = self._loop
        rest_s = schedule.REST_SHARE * loop.params.tick_s if loop.real_time else 0.0
        if 0.0 < timeout_s <= rest_s:
            time.sleep(timeout_s)
            self._hear(now)
            return
        end, until = now + timeout_s, now + max(0.0, timeout_s - rest_s)
        for line in self._lines:
            if line.peer is None and now >= line.next_try:
                self._open(line, now)
        if now >= self._sweep_due:
            self._sweep_due = now + SWEEP_S
            self._sweep(now)
        tick = self._loop.blackbox.next_tick
        if self._turns.tick != tick:
            self._turns.tick = tick
            self._choose_readers(now)
        more = True
        while more:
            # Everybody is heard again and again, so that a stop is obeyed before the next tick.
            accepted = self._hear(until)
            worked = self._turns.queue and self._work(until)
            more = worked or (accepted and self._now() <= until)
        left_s = end - self._now() if timeout_s > 0.0 else 0.0
        if left_s > 0.0:
            # An epoll object waits for whole milliseconds only.
            select.select((self._poll.fileno(),), (), (), left_s)

    def _hear(self, until):
        """Read what has come, and obey a stop. Returns whether there was a new connection.

        If there is more to read than time, those who have waited longest come first.
        """
        ready = self._poll.poll(0)
        if not ready and not self._lines:
            return False
        now = self._now()
        until = max(until, now + HEARING_S)
        accepted = False
        if len(ready) > 1:
            ready.sort(key=self._heard)
        for fd, mask in ready:
            if now > until:
                break
            peer = self._by_fd.get(fd)
            if peer is None:
                peer = self._accept()
                if peer is None:
                    continue
                accepted = True
            # With nothing to read a serial line gives no bytes, just like one that has come off.
            if (mask & _LOST or (peer.reads and mask & select.EPOLLIN)) and not (
                peer.read(now) and self._answer_at_once(peer, now)
            ):
                self._drop(peer)
            elif peer.due:
                self._watch(peer)  # if a frame waits, nothing more is heard until then
            elif peer.frame is not None or peer.out or peer.streaming:
                self._turns.call(peer)
            if len(ready) > 1:
                now = self._now()
        for line in self._lines:
            self._skip_noise(line.peer, now)
        return accepted

    def _heard(self, event):
        """When the link of an event of the poll was heard last (s); new ones come first."""
        peer = self._by_fd.get(event[0])
        return -1.0 if peer is None else peer.heard

    def _answer_at_once(self, peer, now):
        """Obey a stop, and answer a beat, without a turn. Returns whether the link is still open.

        A stop that changes nothing waits for its turn, as all else.
        """
        if peer.frame is not None and peer.frame[0] == wire.BEAT and peer.session.trusted:
            (kind, payload), peer.frame = peer.frame, None
            peer.out += peer.session.receive(kind, payload)
            peer.look()
            if not peer.flush(now):
                return False
        if peer.frame is None or peer.frame[0] != wire.STOP:
            return True
        if self._loop.safety.state in (RUNNING, HELD):
            self._answer(peer)
            return peer.send(now)
        return True

    def _work(self, until):
        """Give peers their turns while there is time, but hear all in between.

        Returns whether there was any turn.
        """
        begin = now = self._now()
        peer = self._turns.next(until)
        worked = peer is not None
        while peer is not None:
            now = self._take_turn(peer, now)
            peer = self._turns.next(until) if now - begin < HEAR_S else None
        return worked

    def _take_turn(self, peer, begin):
        """Answer a peer's frame, and send what it gets. Returns the time."""
        answers = peer.frame is not None
        if answers:
            self._answer(peer)
        if peer.send(begin):
            if peer.ready:
                self._turns.call(peer, again=True)
            self._watch(peer)
        else:
            self._drop(peer)
        now = self._now()
        # A machine that was asleep says nothing about the next turn.
        self._turns.end(answers, min(now - begin, 2.0 * self._loop.params.tick_s))
        return now

    def _choose_readers(self, now):
        """Choose who gets the records of the tick that is over."""
        for line in self._lines:
            self._have_read(line.peer, now)
        self._have_read(self._driver, now)
        left = STREAMS_PER_TICK
        for _ in self._peers:
            self._place = (self._place + 1) % len(self._peers)
            peer = self._peers[self._place]
            if peer is not self._driver and self._have_read(peer, now):
                left -= 1
                if not left:
                    return

    def _have_read(self, peer, now):
        """Give a peer, if there is one, the records that are due to it. Returns whether any are."""
        if peer is None or peer.streaming or not peer.reader(now):
            return False
        peer.streaming = True
        self._turns.call(peer)
        return True

    def _answer(self, peer):
        """Answer a peer's frame, and give it a place if that is what the frame asks for."""
        (kind, payload), peer.frame = peer.frame, None
        session = peer.session
        frames = session.receive(kind, payload)
        if not peer.seated and kind != wire.STOP and session.greeted and not self._seat(peer, kind):
            peer.refuse(
                "busy",
                "all {} places for hosts are taken".format(PLACES),
                "try again in {} s; anyone may stop the robot meanwhile".format(RETRY_S),
                retry_s=RETRY_S,
            )
            return
        if kind == wire.COMMAND and session.client == self._loop.lease.holder:
            self._put_first(peer)
        peer.out += frames
        peer.streaming = session.subscribed
        peer.look()

    def _put_first(self, driver):
        if self._driver is not None:
            self._driver.first = self._driver.lasting
        self._driver = driver
        driver.first = True

    def _seat(self, peer, kind):
        """Give a host a place. Returns False if there is none, and no proof to come that helps."""
        session = peer.session
        places = PLACES + (SPARE_PLACES if session.trusted else 0)
        peer.seated = sum(other.seated and not other.lasting for other in self._peers) < places
        return peer.seated or (kind == wire.HELLO and session.claims)

    def _accept(self):
        """The peer at the other end of a new connection; None if there is none."""
        try:
            descriptor = self._listener._accept()[0]  # noqa: SLF001 - socket.socket has `accept`
        except OSError:
            return None
        link = socket.socket(self._listener.family, fileno=descriptor)
        link.setblocking(False)
        strangers = [peer for peer in self._peers if not peer.seated]
        if len(strangers) >= STRANGERS:
            self._turn_out(strangers[0])
        return self.adopt(link)

    def _turn_out(self, stranger):
        """Have the connection that has been there longest without a host give way."""
        stranger.refuse(
            "busy",
            "too many connections come in at once",
            "try again in {} s".format(RETRY_S),
            retry_s=RETRY_S,
        )
        stranger.send(self._now())
        self._drop(stranger)

    def _open(self, line, now):
        line.next_try = now + LINE_RETRY_S
        try:
            line.peer = self.adopt(line.open(), lasting=True)
        except OSError:
            pass

    def _skip_noise(self, peer, now):
        """Skip what looks like the beginning of a frame if it has not gone on for too long."""
        if peer is None or peer.due or now - peer.heard <= LINE_SILENCE_S:
            return
        peer.decoder.skip()
        peer.look()
        self._answer_at_once(peer, now)
        if peer.ready or peer.out:
            self._turns.call(peer)

    def _sweep(self, now):
        """Hang up on who does not say who it is, and on who reads nothing."""
        for peer in [peer for peer in self._peers if not peer.lasting]:
            patience_s = GREETING_S if peer.session.closing else DEAF_S
            deaf = peer.out and now - peer.moved > patience_s
            if deaf or (not peer.seated and now - peer.since > GREETING_S):
                self._drop(peer)
                if self._now() - now > HEARING_S:
                    self._sweep_due = now  # the others have their sweep in the next call
                    return

    def _watch(self, peer):
        events = peer.events()
        if events != peer.watched:
            peer.watched = events
            self._poll.modify(peer.fd, events)

    def _drop(self, peer):
        self._peers.remove(peer)
        del self._by_fd[peer.fd]
        self._turns.forget(peer)
        if peer is self._driver:
            self._driver = None
        for line in self._lines:
            if line.peer is peer:
                line.peer = None
        self._poll.unregister(peer.fd)
        peer.close()


def _limit(listener):
    """Bound the kernel's buffers of the connections to come, and have it notice lost ones.

    It notices within a minute that the other end is gone.
    """
    listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER_BYTES)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER_BYTES)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPIDLE, 20)
    listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPINTVL, 10)
    listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPCNT, 3)
