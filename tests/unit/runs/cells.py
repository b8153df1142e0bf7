"""What the processes of test_processes.py compute: here, so that they need not import pytest."""

from host.runs.contract import Part


def calls(cell, setting, begun):
    """What the cell, a function, makes of the setting."""
    yield Part([cell(setting)])


def counting(cell, setting, begun):
    """A cell counts up to itself, a number a part."""
    number = begun.state + 1 if begun else 1
    while number < cell:
        yield Part([number], number, number / cell)
        number += 1
    yield Part([number])
