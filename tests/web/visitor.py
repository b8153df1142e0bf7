"""A browser's page in the lab, for tests."""

# A screen of 20 pictures in a second: drawing 60 takes most of what these tests compute.
SLOW_SCREEN = """
const frame = window.requestAnimationFrame.bind(window);
window.requestAnimationFrame = (draw) => setTimeout(() => frame(draw), 40);
window.cancelAnimationFrame = clearTimeout;
"""

# A page that shows its robot.
DRAWN = "r && r.records > 0 && s.drawing.shown_s !== null && s.drawing.frames > 0"


class Visitor:
    """A browser's page in the lab. It fails its test if it complains, as when it asks elsewhere.

    Attributes:
        page: The page, of playwright.
    """

    def __init__(self, browser, url, script="", **context):
        self.complaints = []
        self.context = browser.new_context(
            **{"viewport": {"width": 1280, "height": 720}, **context}
        )
        self.context.add_init_script(SLOW_SCREEN + script)
        self._url = url
        self._open()

    def _open(self):
        self.page = self.context.new_page()
        self.page.on("console", self._hear)
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.goto(self._url)

    def come_back(self):
        """Close the tab, and open the same address in another one."""
        self.page.close()
        self._open()

    def _hear(self, message):
        if message.type in ("error", "warning"):
            self.complaints.append(message.text)

    def forgive(self, beginning):
        """Take no offence at complaints that begin like this."""
        self.complaints = [one for one in self.complaints if not one.startswith(beginning)]

    def state(self):
        """What the page knows."""
        return self.page.evaluate("lab.state()")

    def robot(self):
        """What the page knows of the robot that it shows."""
        state = self.state()
        return state["robots"][state["selected"]]

    def until(self, condition):
        """Wait until a condition on `s`, the page's state, and `r`, its robot, is true and seen."""
        known = "const s = lab.state(), r = s.robots[s.selected]"
        self.page.wait_for_function(f"() => {{ {known}; return !s.drawing.due && ({condition}); }}")

    def reads(self, selector, words):
        """Wait until a part of the page says some words."""
        self.page.wait_for_function(
            "([selector, words]) => document.querySelector(selector).innerText.includes(words)",
            arg=[selector, words],
        )
