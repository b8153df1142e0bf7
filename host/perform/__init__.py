"""Runs experiments and studies by name: finds them with their figures, does their work, reproduces the paper's claims."""
