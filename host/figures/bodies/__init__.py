"""Figures of simulated cars and trains."""
