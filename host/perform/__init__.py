"""Runs experiments and studies by name.

Finds them with their figures, does their work, reproduces the paper's claims.
"""
