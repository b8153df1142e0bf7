"""The badges of README.md: what is true of this version, from its metadata and measured claims.

`python -m docs.site.badges` renews them.
"""

from __future__ import annotations

import tomllib

from docs.site import ROOT
from docs.site.claims import counted
from robot import __version__

FOLDER = ROOT / "docs" / "pictures"
# Of a letter, of the room beside a text, and of a badge (pixels).
_LETTER, _ROOM, _HEIGHT = 7, 8, 20
_GREY, _BLUE = "#505862", "#00579e"


def badges() -> dict[str, str]:
    """The text of each badge's file, by the file's name."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    said = {
        "claims": ("claims of the paper", counted()),
        "version": ("version", __version__),
        "python": ("Python", project["requires-python"].replace(">=", "≥ ")),
    }
    return {f"badge-{name}.svg": _badge(*words) for name, words in said.items()}


def _badge(name: str, value: str) -> str:
    widths = [len(words) * _LETTER + 2 * _ROOM for words in (name, value)]
    left, width = widths[0], sum(widths)
    texts = [
        f'<text x="{begin + _ROOM}" y="14" textLength="{part - 2 * _ROOM}">{words}</text>'
        for words, begin, part in ((name, 0, left), (value, left, widths[1]))
    ]
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{_HEIGHT}">',
            f"<title>{name}: {value}</title>",
            f'<rect width="{width}" height="{_HEIGHT}" rx="3" fill="{_GREY}"/>',
            f'<rect x="{left}" width="{widths[1]}" height="{_HEIGHT}" rx="3" fill="{_BLUE}"/>',
            '<g font-family="DejaVu Sans, Verdana, sans-serif" font-size="12" fill="#fff">',
            *texts,
            "</g>",
            "</svg>\n",
        ]
    )


if __name__ == "__main__":
    for file_name, svg in badges().items():
        (FOLDER / file_name).write_text(svg, encoding="utf-8")
