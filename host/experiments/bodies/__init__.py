"""Experiments on simulated cars and trains."""
