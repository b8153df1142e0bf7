"""What a person uses on the laptop: the command line, the clients of the robot, recordings and experiments."""
