"""Kicks and what comes of them.

The outcome, plans from the kick map, motion primitives, manoeuvres.
"""
