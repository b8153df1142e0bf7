"""A Chromium whose tabs hide each other, as a person's do.

Playwright keeps every page visible: it emulates the focus for each. So this speaks to the browser
by its own protocol.
"""

import asyncio
import re
import tempfile
from contextlib import AsyncExitStack, asynccontextmanager
from itertools import count

import aiohttp


class Tab:
    """One tab of a browser.

    Args:
        call: Says something to the browser: its method, and what belongs to it by name.
        target: The tab's name at the browser.
        session: The name of the connection to the tab.
    """

    def __init__(self, call, target, session):
        self._call = call
        self._target = target
        self._session = session

    async def ask(self, expression):
        """The value of an expression in the page."""
        answer = await self._call(
            "Runtime.evaluate",
            session=self._session,
            expression=expression,
            returnByValue=True,
            awaitPromise=True,
        )
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    async def until(self, condition):
        """Wait until a condition on `s`, the state of the lab's page, and `r`, its robot, holds."""
        known = "const s = window.lab?.state(), r = s?.robots[s.selected]"
        await self.until_true(f"(() => {{ {known}; return Boolean(s && ({condition})); }})()")

    async def until_true(self, expression):
        """Wait until an expression in the page is true. A hidden page's own timers are slow."""
        while True:
            if await self.ask(expression):
                return
            await asyncio.sleep(0.02)

    async def press(self, selector):
        """Click on a button once the page lets it be clicked on: a click before that is lost."""
        button = f"document.querySelector({selector!r})"
        await self.until_true(f"{button}?.disabled === false")
        await self.ask(f"{button}.click()")

    async def show(self):
        """Bring the tab to the front."""
        await self._call("Target.activateTarget", targetId=self._target)

    async def size_window(self, state):
        """Make the tab's window `minimized` or `normal`."""
        window = await self._call("Browser.getWindowForTarget", targetId=self._target)
        bounds = {"windowState": state}
        await self._call("Browser.setWindowBounds", windowId=window["windowId"], bounds=bounds)


@asynccontextmanager
async def open_browser(chromium):
    """Begin a browser, and end it.

    Args:
        chromium: The program's path.

    Yields:
        A function that opens an address in a new tab, which hides those before it.
    """
    async with AsyncExitStack() as stack:
        folder = stack.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True))
        # The window that it would begin with shows itself late, also a page minimized by then.
        options = ["--headless=new", "--no-sandbox", "--no-startup-window"]
        options.append("--remote-debugging-port=0")
        process = await asyncio.create_subprocess_exec(
            chromium, *options, f"--user-data-dir={folder}", stderr=asyncio.subprocess.PIPE
        )
        stack.push_async_callback(process.wait)
        stack.callback(process.kill)
        while not (address := re.search(rb"ws://\S+", await process.stderr.readline())):
            assert process.returncode is None
        client = await stack.enter_async_context(aiohttp.ClientSession())
        socket = await stack.enter_async_context(client.ws_connect(address.group().decode()))
        numbers = count(1)

        async def call(method, session=None, **params):
            number = next(numbers)
            message = {"id": number, "method": method, "params": params}
            await socket.send_json({**message, "sessionId": session} if session else message)
            while (answer := await socket.receive_json()).get("id") != number:
                pass  # what the browser says by itself
            assert "error" not in answer, answer
            return answer["result"]

        async def open_tab(url):
            target = (await call("Target.createTarget", url=url))["targetId"]
            session = await call("Target.attachToTarget", targetId=target, flatten=True)
            return Tab(call, target, session["sessionId"])

        yield open_tab
