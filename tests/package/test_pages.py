"""README and docs: short, their lines fit, their links lead somewhere."""

import re

import pytest

from tests.package.conftest import ROOT

PAGES = [
    "README.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "SECURITY.md",
    "robot/README.md",
    "robot/PROTOCOL.md",
    "host/GLOSSARY.md",
] + sorted(str(path.relative_to(ROOT)) for path in (ROOT / "docs").rglob("*.md"))


def prose(text):
    """The lines outside of tables; a table's row cannot be broken."""
    return [line for line in text.splitlines() if not line.startswith("|")]


@pytest.mark.parametrize("page", PAGES)
def test_lines_fit_and_links_lead_to_files(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    assert [line for line in prose(text) if len(line) > 100] == []
    links = re.findall(r"\]\(([^)#]+)\)", text)
    near = [link for link in links if "://" not in link]
    assert [link for link in near if not (ROOT / page).parent.joinpath(link).exists()] == []


def test_the_readme_is_read_in_five_minutes():
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= 120


def test_every_page_is_in_the_index():
    index = (ROOT / "docs" / "README.md").read_text(encoding="utf-8")
    docs = ROOT / "docs"
    pages = {str(path.relative_to(docs)) for path in docs.rglob("*.md")} - {"README.md"}
    assert {page for page in pages if f"({page})" not in index} == set()
