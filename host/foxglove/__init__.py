"""Live channels for Foxglove and Lichtblick: a robot's stream over their WebSocket protocol."""
