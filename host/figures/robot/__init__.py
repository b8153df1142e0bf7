"""Figures of the robot's experiments."""
