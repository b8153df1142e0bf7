"""Runs experiments and studies by name, and reproduces the paper's claims."""
