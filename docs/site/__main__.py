"""`python -m docs.site`: build the site in build/docs. Each warning is an error."""

import argparse
import sys
from pathlib import Path

from docs.site import ROOT
from docs.site.layout import lay_out


def build(folder: Path, notebooks: str) -> int:
    """Build the site.

    Args:
        folder: Where it goes: `html` in it. Notebooks that have run stay there for the next build.
        notebooks: Whether they are run: 'off', or 'cache' for those that have changed.

    Returns:
        The exit status, 0 if there was no warning.
    """
    from sphinx.cmd.build import build_main

    pages = folder / "pages"
    lay_out(pages)
    # Sphinx would not warn of pages that it does not read again, and forget their index entries.
    return build_main(
        [
            *("-b", "html", "-c", str(ROOT / "docs" / "site"), "-d", str(folder / "doctrees")),
            *("-D", f"nb_execution_mode={notebooks}", "--fail-on-warning", "--fresh-env"),
            *(["--quiet"] if notebooks == "off" else []),
            *(str(pages), str(folder / "html")),
        ]
    )


def main() -> int:
    """Build the site as the command line says. Returns the exit status."""
    arguments = argparse.ArgumentParser(prog="python -m docs.site", description="Builds the site.")
    arguments.add_argument(
        "--quick", action="store_true", help="show notebooks without running them"
    )
    quick = arguments.parse_args().quick
    if not quick:
        print("Notebooks that have changed are run first: up to 5 minutes for all.", flush=True)
        print("Warnings of IPKernelApp, about encryption within this computer, mean nothing here.")
    folder = ROOT / "build" / ("docs-quick" if quick else "docs")
    status = build(folder, "off" if quick else "cache")
    if not status:
        print(f"The site: {folder / 'html' / 'index.html'}")
    return status


if __name__ == "__main__":
    sys.exit(main())
