"""Part of kickctl. The robot: what runs on the brick. CPython 3.5 and its standard library.

It imports nothing of the other rooms.
"""

__version__ = "0.2.0"
