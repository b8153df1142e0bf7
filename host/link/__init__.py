"""Bytes to and from a robot: addresses, sockets, serial lines, ssh, simulation, discovery."""
