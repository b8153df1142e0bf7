"""Simulated cars and trains for people.

Built from what was asked for, steered, written to files.
"""
