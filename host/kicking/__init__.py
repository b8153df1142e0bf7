"""Kicks and what comes of them: the outcome, plans from the kick map, motion primitives, manoeuvres."""
