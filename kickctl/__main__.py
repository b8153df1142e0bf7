"""The command `kickctl`, also as `python -m kickctl`.

The package has looked for foreign parts by the time this is imported, so that is said in words.
"""

from __future__ import annotations

import sys


def main() -> int:
    """Run one verb. Returns the exit status."""
    try:
        from host.cli import main as run
    except KeyboardInterrupt:  # run() answers later ones
        if "--json" in sys.argv:
            print('{"error": {"message": "interrupted", "hint": "", "status": 130}}')
        return 130
    return run()


if __name__ == "__main__":
    sys.exit(main())
