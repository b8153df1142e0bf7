"""Logs of a robot's ticks: in memory, in files, as tables, replayed, and what the wheels did in them."""
