"""Simulated cars and trains for people: build, kick and steer them, and write files."""
