"""Films: pictures in a row, MuJoCo's camera, and the course of a wheel's rods."""
