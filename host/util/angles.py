"""Angles as people write them: 2.36, pi, -3pi/4."""

from __future__ import annotations

import argparse
import re
from math import inf, pi

_FORM = re.compile(r"([+-]?)(\d+(?:\.\d*)?|\.\d+)?(?:\*?(pi))?(?:/(\d+(?:\.\d*)?))?", re.ASCII)


def parse_angle(text: str) -> float:
    """The angle in rad. Raises argparse.ArgumentTypeError, which argparse shows as a message."""
    match = _FORM.fullmatch(text.replace(" ", ""))
    value = inf
    if match is not None and (match[2] or match[3]) and not (match[4] and not float(match[4])):
        value = float(match[2] or 1.0) * (pi if match[3] else 1.0) / float(match[4] or 1.0)
    if match is None or not value < inf:
        raise argparse.ArgumentTypeError(
            f"'{text}' is not an angle; write it in rad and with a point, as in 2.36 or -3pi/4"
        )
    return -value if match[1] == "-" else value
