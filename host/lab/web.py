"""The lab's web server: the page's files, the logs, and a WebSocket for each page.

It listens to nobody who does not name it by the address on which it listens, so that a foreign
site in the same browser cannot talk to it, not even under a name that leads here.
"""

from __future__ import annotations

import asyncio
import re
from collections.abc import Awaitable, Callable
from contextlib import suppress
from ipaddress import ip_address
from pathlib import Path

from aiohttp import WSMsgType, web

from host.errors import KickctlError
from host.lab.outgoing import outgoing
from host.lab.page_end import Page
from host.lab.page_files import FIRST, PAGE_FOLDER, one_module
from host.lab.replays import Replays
from host.lab.requests import MAX_BYTES
from host.lab.session import Session

TYPES = {
    ".html": "text/html",
    ".js": "text/javascript",
    ".css": "text/css",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".json": "application/json",
    ".woff2": "font/woff2",
}
_PLAIN = re.compile(r"(?:[a-z0-9_-]{1,60}/){0,3}[a-z0-9_-]{1,60}\.[a-z0-9]{1,5}", re.ASCII)
HEADERS = {
    "Cache-Control": "no-cache",
    "Content-Security-Policy": "default-src 'self'; frame-ancestors 'none'",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}
# How long a page that is let go may take to read why (s).
GOODBYE_S = 2.0

_Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


class Site:
    """What the server answers.

    Args:
        session: The lab's session.
        folder: The page's files.
        replays: Where logs are read for pages; None if nowhere.
    """

    def __init__(
        self, session: Session, folder: Path = PAGE_FOLDER, replays: Replays | None = None
    ) -> None:
        self._session = session
        self._replays = replays
        self._folder = folder.resolve()
        self._sockets: set[web.WebSocketResponse] = set()

    def application(self) -> web.Application:
        """The application that a runner serves."""
        application = web.Application(middlewares=[_guard], client_max_size=MAX_BYTES)
        application.router.add_get("/messages", self._messages)
        application.router.add_get("/logs/{name}", self._log)
        application.router.add_get("/replays/{name}", self._replay)
        application.router.add_get("/{path:.*}", self._file)
        application.on_shutdown.append(self._hang_up)
        return application

    def wake(self) -> None:
        """Have every page get what is new."""
        for page in self._session.pages.values():
            page.awake()

    async def _hang_up(self, application: web.Application) -> None:
        ends = [
            asyncio.create_task(socket.close(message=b"the lab ends")) for socket in self._sockets
        ]
        if ends:
            await asyncio.wait(ends, timeout=GOODBYE_S)
        if self._replays is not None:  # who waits for a log gets an answer
            await asyncio.to_thread(self._replays.close)

    # Files.

    async def _file(self, request: web.Request) -> web.StreamResponse:
        path = request.match_info["path"] or "index.html"
        kind = TYPES.get(Path(path).suffix)
        # Only plain names: no way leads out of the folder, but a link, which `resolve` follows.
        place = (self._folder / path).resolve() if _PLAIN.fullmatch(path) else None
        if not (kind and place and place.is_relative_to(self._folder) and place.is_file()):
            raise web.HTTPNotFound(text="there is no such page\n")
        text = kind.startswith("text/") or kind.endswith("json")
        first = path in FIRST and self._folder == PAGE_FOLDER.resolve()
        return web.Response(
            body=one_module(path).encode() if first else place.read_bytes(),
            content_type=kind,
            charset="utf-8" if text else None,
        )

    async def _log(self, request: web.Request) -> web.StreamResponse:
        path = self._recorded(request)
        return web.FileResponse(
            path,
            headers={
                "Content-Type": "application/octet-stream",
                "Content-Disposition": f'attachment; filename="{path.name}"',
            },
        )

    async def _replay(self, request: web.Request) -> web.StreamResponse:
        self._need_key(request)
        if self._replays is None:
            raise web.HTTPNotFound(text="this lab replays no logs\n")
        text = self._replays.given(request.match_info["name"])
        if text is None:
            try:
                text = await self._replays.read(self._recorded(request))
            except KickctlError as error:
                raise web.HTTPConflict(text=f"{error.in_a_line}\n") from error
        return web.Response(text=text, content_type="application/json")

    def _recorded(self, request: web.Request) -> Path:
        """The log that a request names. Raises HTTPException."""
        self._need_key(request)
        path = self._session.log(request.match_info["name"])
        if path is None or not path.is_file():
            raise web.HTTPNotFound(text="this lab has recorded no such log\n")
        return path

    def _need_key(self, request: web.Request) -> None:
        """Raise HTTPUnauthorized if a request comes without the lab's key."""
        scheme, _, key = request.headers.get("Authorization", "").partition(" ")
        if scheme.lower() != "bearer" or not self._session.may_read(key, local=_is_local(request)):
            raise web.HTTPUnauthorized(
                text="logs need the lab's key: open the whole address that kickctl lab prints, with"
                " what follows the #\n",
                headers={"WWW-Authenticate": "Bearer"},
            )

    # Messages.

    async def _messages(self, request: web.Request) -> web.StreamResponse:
        if request.headers.get("Origin") is None:
            raise web.HTTPForbidden(text="only the lab's own page may talk to it\n")
        socket = web.WebSocketResponse(
            compress=False, timeout=GOODBYE_S, max_msg_size=16 * MAX_BYTES, heartbeat=20.0
        )
        await socket.prepare(request)
        session, now = self._session, asyncio.get_running_loop().time
        page = session.arrive(now(), local=_is_local(request))
        self._sockets.add(socket)
        sender = asyncio.create_task(self._send(socket, page, request))
        try:
            async for message in socket:
                if message.type in (WSMsgType.TEXT, WSMsgType.BINARY):
                    text = message.data if message.type == WSMsgType.TEXT else ""
                    session.receive(page, text, now())
                    await asyncio.sleep(0)  # who sends much must not keep others waiting
        finally:
            session.leave(page)
            self._sockets.discard(socket)
            sender.cancel()
            with suppress(asyncio.CancelledError, ConnectionError):
                await sender
        return socket

    async def _send(self, socket: web.WebSocketResponse, page: Page, request: web.Request) -> None:
        """Send a page what waits for it. Only this task waits if the page does not read."""
        loop = asyncio.get_running_loop()
        news = asyncio.Event()
        letting_go = False

        def awake() -> None:
            nonlocal letting_go
            news.set()
            if page.closed and not letting_go and request.transport is not None:
                letting_go = True
                loop.call_later(GOODBYE_S, request.transport.abort)

        page.awake = awake
        awake()
        with suppress(ConnectionError):
            while True:
                await news.wait()
                news.clear()
                for data in outgoing(page, self._session.rings):
                    if isinstance(data, str):
                        await socket.send_str(data)
                    else:
                        await socket.send_bytes(data)
                if page.closed:
                    await socket.close()
                    return


@web.middleware
async def _guard(request: web.Request, handler: _Handler) -> web.StreamResponse:
    """Refuse who names another host, or comes from another site; give answers safe headers."""
    hosts = _own_hosts(request)
    origin = request.headers.get("Origin")
    try:
        if request.headers.get("Host", "") not in hosts:
            raise web.HTTPMisdirectedRequest(
                text="this lab has another address: use the one that it has printed\n"
            )
        if origin is not None and origin not in [f"http://{host}" for host in hosts]:
            raise web.HTTPForbidden(text="only the lab's own page may talk to it\n")
        response = await handler(request)
    except web.HTTPException as refusal:
        refusal.headers.update(HEADERS)
        raise
    if not response.prepared:
        response.headers.update(HEADERS)
    return response


def _address(request: web.Request, end: str) -> tuple[str, int]:
    """The address of one end of the connection: 'sockname' is this one, 'peername' the other."""
    found = request.transport.get_extra_info(end) if request.transport else None
    return (str(found[0]), int(found[1])) if found else ("", 0)


def _own_hosts(request: web.Request) -> list[str]:
    """What the Host header may say: the address at which the connection has come in."""
    host, port = _address(request, "sockname")
    hosts = [f"[{host}]:{port}" if ":" in host else f"{host}:{port}"]
    if host and ip_address(host).is_loopback:
        hosts.append(f"localhost:{port}")
    if port == 80:
        hosts += [name.removesuffix(":80") for name in hosts]
    return hosts


def _is_local(request: web.Request) -> bool:
    """Whether the other end is on this computer."""
    peer, _ = _address(request, "peername")
    own, _ = _address(request, "sockname")
    return bool(peer) and (peer == own or ip_address(peer).is_loopback)
