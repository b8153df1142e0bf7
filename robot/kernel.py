"""Sockets and signals as the kernel has them.

Python's own modules `socket` and `signal` make enumerations of their constants at each start, which
takes a brick 0.8 s.
"""

import _signal as signal  # type: ignore[import-not-found]
import _socket as socket

__all__ = ("signal", "socket")
