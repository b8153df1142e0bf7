"""`python -m docs.site`: build the site in build/docs. Each warning is an error."""

import argparse
import sys
from functools import partial
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
    if notebooks != "off":
        _encrypt_kernels()
    # Sphinx would not warn of pages that it does not read again, and forget their index entries.
    return build_main(
        [
            *("-b", "html", "-c", str(ROOT / "docs" / "site"), "-d", str(folder / "doctrees")),
            *("-D", f"nb_execution_mode={notebooks}", "--fail-on-warning", "--fresh-env"),
            *(["--quiet"] if notebooks == "off" else []),
            *(str(pages), str(folder / "html")),
        ]
    )


def _encrypt_kernels() -> None:
    """Have notebooks talk to their kernels in secret: without that each kernel warns."""
    from jupyter_cache.executors import utils
    from traitlets.config import Config

    # MyST-NB has no setting for it.
    secret = Config(KernelManager={"transport_encryption": "auto"})
    utils.executenb = partial(utils.executenb, config=secret)


def main() -> int:
    """Build the site as the command line says. Returns the exit status."""
    arguments = argparse.ArgumentParser(prog="python -m docs.site", description="Builds the site.")
    arguments.add_argument(
        "--quick", action="store_true", help="show notebooks without running them"
    )
    quick = arguments.parse_args().quick
    if not quick:
        print("Notebooks that have changed are run first: up to 5 minutes for all.", flush=True)
    folder = ROOT / "build" / ("docs-quick" if quick else "docs")
    status = build(folder, "off" if quick else "cache")
    if not status:
        print(f"The site: {folder / 'html' / 'index.html'}")
    return status


if __name__ == "__main__":
    sys.exit(main())
