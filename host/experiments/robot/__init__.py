"""Experiments on the robot, real or simulated."""
