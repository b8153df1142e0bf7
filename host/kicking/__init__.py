"""Kicks and their outcome: plans from the kick map, motion primitives, manoeuvres, claims."""
