"""Every experiment with the robot and with simulated bodies, one file each, listed in host.experiments.registry."""
