"""Part of kickctl. What a person uses on the laptop.

The command line, the clients of the robot, recordings and experiments.
"""
