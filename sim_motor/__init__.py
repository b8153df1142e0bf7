"""Part of kickctl. It stands in for hardware.

A simulated EV3 with two large motors, in virtual or in real time, alone or by the thousand.
"""
