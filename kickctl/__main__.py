"""The command `kickctl`, also as `python -m kickctl`.

The package has looked for foreign parts by the time this is imported, so that is said in words.
"""

from __future__ import annotations

import signal
import sys


def main() -> int:
    """Run one verb. Returns the exit status."""
    try:
        from host.cli import main as run
    except KeyboardInterrupt:  # run() answers later ones
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        if "--json" in sys.argv:
            print('{"error": {"message": "interrupted", "hint": "", "status": 130}}')
        print("kickctl: interrupted", file=sys.stderr)
        return 130
    return run()


if __name__ == "__main__":
    sys.exit(main())
