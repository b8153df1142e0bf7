"""What the lab's server gives to a browser that asks for the page's first module."""

import os
import re
import shutil

import pytest

from host.lab import page_files
from host.lab.page_files import FIRST, PAGE_FOLDER, one_module, page_modules
from host.lab.server import Lab
from tests.lab.browser import browse, site

_IMPORT = re.compile(r"^import\s.*?;$", re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("first", FIRST)
def test_a_browser_gets_all_modules_in_one(first):
    async def scenario(browser):
        with Lab([], port=0) as lab:
            async with browser.http.get(f"{site(lab.drive_url)}/{first}") as answer:
                return answer.headers["Content-Type"], await answer.text()

    kind, served = browse(scenario)
    assert kind == "text/javascript; charset=utf-8"
    assert not re.search(r"^(import|export)\b", served, re.MULTILINE)
    at = 0
    for name in page_modules(first):
        text = (PAGE_FOLDER / name).read_text("utf-8")
        own = re.sub(r"^export ", "", _IMPORT.split(text)[-1], flags=re.MULTILINE)
        at = served.index(own, at)  # behind all that it imports


def test_a_page_names_the_modules_that_are_first():
    named = [
        re.findall(r'<script type="module" src="([^"]+)"', page.read_text("utf-8"))
        for page in sorted(PAGE_FOLDER.glob("*.html"))
    ]
    assert named == [[first] for first in FIRST]


def test_a_module_that_was_changed_is_another_one_at_the_next_load(tmp_path, monkeypatch):
    folder = shutil.copytree(PAGE_FOLDER, tmp_path / "page")
    monkeypatch.setattr(page_files, "PAGE_FOLDER", folder)
    before = one_module("main.js")
    changed = folder / "draw" / "wheel.js"
    with changed.open("a", encoding="utf-8") as file:
        file.write("// changed\n")
    os.utime(changed, ns=(2**62, 2**62))  # later than all others
    assert one_module("main.js").splitlines() != before.splitlines()
    assert "// changed" in one_module("main.js")
