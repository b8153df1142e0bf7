"""Simulated cars and trains for people: built from what was asked for, steered, written to files."""
