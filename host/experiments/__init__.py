"""The experiments with the robot and with simulated bodies; `registry` lists them."""
