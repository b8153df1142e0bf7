"""Every experiment with the robot: one file each, run by host.experiments.run, listed in host.experiments.table."""
