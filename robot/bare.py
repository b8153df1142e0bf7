"""The standard library's parts in C, without those in Python around them.

A start of `socket` and `signal` makes enumerations of constants, that of `hashlib` looks for every
kind of hash, and the others import more modules: together that takes a brick 1.2 s.
"""

import _signal as signal  # type: ignore[import-not-found]
import _socket as socket
from _bisect import bisect_left
from _operator import _compare_digest as compare_digest
from _random import Random

try:
    from _sha256 import sha256  # type: ignore[import-not-found]
except ImportError:  # Python 3.12 and newer; PyPy
    from hashlib import sha256

__all__ = ("Random", "bisect_left", "compare_digest", "sha256", "signal", "socket")
