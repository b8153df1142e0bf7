"""Bytes to and from a robot: addresses, sockets, serial lines, ssh, the embedded simulation, discovery."""
