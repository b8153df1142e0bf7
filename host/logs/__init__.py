"""Logs of a robot's ticks: in memory, in files, as tables, replayed, and how wheels move."""
