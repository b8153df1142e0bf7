"""Makes a folder with the lab's page that runs the robot by itself, on any web server.

`make page` gets Pyodide, a Python for browsers, and runs this.
"""

from __future__ import annotations

import argparse
import hashlib
import io
import json
import shutil
import sys
import zipfile
from pathlib import Path

import host
import robot
import sim_motor
from host.errors import KickctlError, NotDone
from host.lab.page_files import PAGE_FOLDER

# What a browser loads of Pyodide. Its module gets the ending that all web servers know.
RUNTIME = {
    "pyodide.mjs": "pyodide.js",
    "pyodide.asm.mjs": "pyodide.asm.js",
    "pyodide.asm.wasm": "pyodide.asm.wasm",
    "pyodide-lock.json": "pyodide-lock.json",
    "python_stdlib.zip": "python_stdlib.zip",
}
# What the lab's Python needs of host/; the other rooms go as a whole.
_OF_HOST = (
    "*.py",
    *(f"{room}/**/*.py" for room in ("client", "kicking", "lab", "link", "logs", "runs", "util")),
)
_DATA = ("lab/**/*.toml",)
# Only WebAssembly is allowed beside what the lab's server allows.
_POLICY = "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'"
_HEAD = f"""\
    <meta http-equiv="Content-Security-Policy" content="{_POLICY}" />
    <meta name="alone" content="yes" />
"""
_BEHIND = '<meta charset="utf-8" />\n'
_LEFT_OUT = ("replay.html",)
_SAME_TIME = (1980, 1, 1, 0, 0, 0)


def build(folder: Path, pyodide: Path) -> int:
    """Write the page's folder.

    Args:
        folder: Where it goes; what is there is removed.
        pyodide: The folder of the npm package.

    Returns:
        How many bytes the page has.

    Raises:
        NotDone: Pyodide is not there, or it is another release than this one knows.
        OSError: The disk fails, or is full.
    """
    files = _page() | _runtime(pyodide) | {"python.zip": _sources()}
    digest = hashlib.sha256()
    for name, content in sorted(files.items()):
        digest.update(f"{name}\0{len(content)}\0".encode() + content)
    cache, names = digest.hexdigest()[:16], ["./", *sorted(files)]
    head = f"const CACHE = {_text(cache)};\nconst FILES = {_text(names)};\n"
    files["offline.js"] = head.encode() + (PAGE_FOLDER / "offline.js").read_bytes()
    shutil.rmtree(folder, ignore_errors=True)
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    return sum(map(len, files.values()))


def _page() -> dict[str, bytes]:
    """The page's own files, by name."""
    files = {
        str(path.relative_to(PAGE_FOLDER)): path.read_bytes()
        for path in PAGE_FOLDER.rglob("*.*")
        if path.name not in (*_LEFT_OUT, "offline.js")
    }
    begin, behind, rest = files["index.html"].decode().partition(_BEHIND)
    files["index.html"] = (begin + behind + _HEAD + rest).encode()
    return files


def _runtime(pyodide: Path) -> dict[str, bytes]:
    """Pyodide's files, by name."""
    missing = [name for name in RUNTIME if not (pyodide / name).is_file()]
    if missing:
        raise NotDone(
            f"Pyodide is not in {pyodide}: there is no {', '.join(missing)}",
            "`make page` gets it by npm",
        )
    files = {f"pyodide/{new}": (pyodide / name).read_bytes() for name, new in RUNTIME.items()}
    module = files["pyodide/pyodide.js"]
    if b"pyodide.asm.mjs" not in module:
        raise NotDone(
            "this Pyodide loads its parts in another way than the one that this page knows",
            "take the release in host/lab/pyodide/package.json",
        )
    files["pyodide/pyodide.js"] = module.replace(b"pyodide.asm.mjs", b"pyodide.asm.js")
    return files


def _sources() -> bytes:
    """The Python of the page as a zip file, the same bytes for the same sources."""
    rooms = {
        host: (*_OF_HOST, *_DATA),
        robot: ("*.py",),
        sim_motor: ("*.py", "*.toml"),
    }
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for room, patterns in rooms.items():
            root = Path(room.__path__[0])
            for path in sorted({path for pattern in patterns for path in root.glob(pattern)}):
                name = str(path.relative_to(root.parent))
                entry = zipfile.ZipInfo(name, _SAME_TIME)
                entry.compress_type = zipfile.ZIP_DEFLATED
                archive.writestr(entry, path.read_bytes())
    return packed.getvalue()


def _text(value: object) -> str:
    return json.dumps(value, allow_nan=False)


def main(arguments: list[str] | None = None) -> int:
    """Build the page from the command line. Returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m host.lab.static_page", description=__doc__)
    parser.add_argument("pyodide", type=Path, help="the folder of the npm package pyodide")
    parser.add_argument("folder", type=Path, help="where the page goes; what is there is removed")
    options = parser.parse_args(arguments)
    try:
        size = build(options.folder, options.pyodide)
    except KickctlError as error:
        print(f"make page: {error.message}\n  {error.hint}", file=sys.stderr)
        return 1
    print(
        f"{options.folder} has the page, {size / 1e6:.0f} MB: put it on any web server. To try it"
        f" here:\n  python3 -m http.server --bind 127.0.0.1 --directory {options.folder}\n"
        "then open http://127.0.0.1:8000"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
