"""Films of simulated bodies, and of the rods of a robot's wheel."""
