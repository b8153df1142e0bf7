"""A browser's window for many tests: each opens tabs of its own in it.

A page opens in a new tab of a window for two thirds of what it takes in a new window: the tab's
process is there, and has compiled the page's scripts. A tab that crashes takes the window with it.
"""

from urllib.parse import urlsplit

# Tabs stay in the first one's process, since the labs are on this host, too.
HOST = "http://127.0.0.1/"


class Window:
    """A window of a browser. For visitors it is a browser that nobody has used before.

    Args:
        browser: Of playwright.
    """

    def __init__(self, browser):
        self.context = browser.new_context()
        self.first = self.context.new_page()
        self.first.route("**", lambda route: route.fulfill(body="", content_type="text/html"))
        self.first.goto(HOST)

    def clear(self, addresses):
        """Close all tabs, and forget what pages at some addresses have stored."""
        for page in self.context.pages:
            if page is not self.first:
                page.close()
        tools = self.context.new_cdp_session(self.first)
        for address in addresses:
            scheme, host, *_ = urlsplit(address)
            origin = {"origin": f"{scheme}://{host}", "storageTypes": "all"}
            tools.send("Storage.clearDataForOrigin", origin)
        tools.detach()

    def new_context(self, viewport, **media):
        """What a visitor opens tabs in: of this size, and for these media."""
        return Tabs(self, viewport, media)


class Tabs:
    """The tabs of one visitor, in place of a context of playwright."""

    def __init__(self, window, viewport, media):
        self._window = window
        self._viewport = viewport
        self._media = media
        self._scripts = []
        self._pages = []

    def add_init_script(self, script):
        """Have each tab run a script before those of its page."""
        self._scripts.append(script)

    def new_page(self):
        """Open a tab."""
        window = self._window
        with window.context.expect_page() as opened:
            window.first.evaluate("void open('about:blank')")
        page = opened.value
        self._pages.append(page)
        page.set_viewport_size(self._viewport)
        page.emulate_media(**self._media)
        for script in self._scripts:
            page.add_init_script(script)
        return page

    def close(self):
        """Close all tabs of the window, and forget what their pages have stored."""
        self._window.clear({page.url for page in self._pages})
