"""A window that visitors share: none finds anything of the one before."""

from tests.web.visitor import DRAWN, Visitor
from tests.web.window import Window

KEEP = """
    for (const store of [localStorage, sessionStorage]) store.setItem("lab.projector", "true");
    document.cookie = "lab=1";
    caches.open("lab");
"""
FOUND = """
    async () => ({
        stored: localStorage.length + Object.keys(sessionStorage).filter((key) =>
            key !== "lab.page" && key !== "lab.key").length,
        cookies: document.cookie,
        caches: await caches.keys(),
        size: [innerWidth, innerHeight],
        dark: matchMedia("(prefers-color-scheme: dark)").matches,
        script: "script" in window,
        hover: [...document.querySelectorAll("button:hover")].length,
    })
"""


def test_a_visitor_finds_nothing_of_the_one_before(browser, lab):
    window = Window(browser)
    script = "window.script = true;"
    small = {"width": 640, "height": 480}
    before = Visitor(window, lab.drive_url, script, viewport=small, color_scheme="dark")
    before.until(DRAWN)
    before.page.hover("#stop")
    before.page.evaluate(KEEP)
    before.context.close()
    fresh = Visitor(browser, lab.drive_url)
    after = Visitor(window, lab.drive_url)
    for visitor in (fresh, after):
        visitor.until(DRAWN)
    assert after.page.evaluate(FOUND) == fresh.page.evaluate(FOUND)
    assert after.complaints == []
    for visitor in (fresh, after):
        visitor.context.close()
