"""A replay as one HTML file, which needs no server and no network.

The file holds the page of a replay with its style sheets, its modules and the tape. The modules are
those of the served page: an import map leads from their names to their texts.
"""

from __future__ import annotations

import base64
import json
import re
from pathlib import PurePosixPath
from typing import Any

from host.lab.web import PAGE_FOLDER

# Nothing can be asked for from anywhere.
_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline' data:; style-src 'unsafe-inline'; img-src data:"
)
_IMPORT = re.compile(r'(\bfrom\s+|\bimport\s+)"(\./[\w./]+)"')
_STYLE = re.compile(r'<link rel="stylesheet" href="([\w.]+)" />')
_SCRIPT = re.compile(r'<script type="module" src="([\w.]+)"></script>')
_ICON = re.compile(r'href="(icon\.svg)"')


def one_file(tape: dict[str, Any]) -> str:
    """The page of a replay as one HTML text.

    Args:
        tape: As host.lab.tape.make_tape returns it.
    """
    page = _text("replay.html")
    page = page.replace(
        '<meta charset="utf-8" />',
        '<meta charset="utf-8" />\n'
        f'    <meta http-equiv="Content-Security-Policy" content="{_POLICY}" />',
    )
    page = _ICON.sub(lambda found: f'href="{_url(_text(found[1]), "image/svg+xml")}"', page)
    page = _STYLE.sub(lambda found: f"<style>\n{_text(found[1])}</style>", page)
    return _SCRIPT.sub(lambda found: _scripts(found[1], tape), page)


def _scripts(first: str, tape: dict[str, Any]) -> str:
    modules: dict[str, str] = {}
    _collect(first, modules)
    table = {
        "imports": {f"lab/{name}": _url(text, "text/javascript") for name, text in modules.items()}
    }
    return "\n".join(
        [
            f'<script type="importmap">{_inside(table)}</script>',
            f'<script type="application/json" id="tape">{_inside(tape)}</script>',
            f'<script type="module">import "lab/{first}";</script>',
        ]
    )


def _collect(name: str, modules: dict[str, str]) -> None:
    """Collect a module and all that it imports, under names that do not depend on the place."""
    if name in modules:
        return
    needs: list[str] = []

    def named(found: re.Match[str]) -> str:
        needs.append(str(PurePosixPath(name).parent / found[2]))
        return f'{found[1]}"lab/{needs[-1]}"'

    modules[name] = _IMPORT.sub(named, _text(name))
    for one in needs:
        _collect(one, modules)


def _inside(data: object) -> str:
    """JSON that cannot end the script in which it stands."""
    return json.dumps(data, allow_nan=False).replace("<", "\\u003c")


def _text(name: str) -> str:
    return (PAGE_FOLDER / name).read_text(encoding="utf-8")


def _url(text: str, kind: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(text.encode()).decode('ascii')}"
