"""A replay as one HTML file, which needs no server and no network.

The file holds the page of a replay with its style sheets, its modules and the tape. The modules are
those of the served page: an import map leads from their names to their texts.
"""

from __future__ import annotations

import base64
import json
import re
from typing import Any

from host.lab.page_files import page_modules, page_text

# Nothing can be asked for from anywhere.
_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline' data:; style-src 'unsafe-inline'; img-src data:"
)
_STYLE = re.compile(r'<link rel="stylesheet" href="([\w.]+)" />')
_SCRIPT = re.compile(r'<script type="module" src="([\w.]+)"></script>')
_ICON = re.compile(r'href="(icon\.svg)"')


def one_file(tape: dict[str, Any]) -> str:
    """The page of a replay as one HTML text.

    Args:
        tape: As host.lab.tape.make_tape returns it.
    """
    page = page_text("replay.html")
    page = page.replace(
        '<meta charset="utf-8" />',
        '<meta charset="utf-8" />\n'
        f'    <meta http-equiv="Content-Security-Policy" content="{_POLICY}" />',
    )
    page = _ICON.sub(lambda found: f'href="{_url(page_text(found[1]), "image/svg+xml")}"', page)
    page = _STYLE.sub(lambda found: f"<style>\n{page_text(found[1])}</style>", page)
    return _SCRIPT.sub(lambda found: _scripts(found[1], tape), page)


def _scripts(first: str, tape: dict[str, Any]) -> str:
    modules = page_modules(first).items()
    table = {"imports": {f"lab/{name}": _url(text, "text/javascript") for name, text in modules}}
    return "\n".join(
        [
            f'<script type="importmap">{_inside(table)}</script>',
            f'<script type="application/json" id="tape">{_inside(tape)}</script>',
            f'<script type="module">import "lab/{first}";</script>',
        ]
    )


def _inside(data: object) -> str:
    """JSON that cannot end the script in which it stands."""
    return json.dumps(data, allow_nan=False).replace("<", "\\u003c")


def _url(text: str, kind: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(text.encode()).decode('ascii')}"
