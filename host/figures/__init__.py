"""Figures, one file each; matplotlib is loaded when one is drawn, and needs no display."""

from host.figures._matplotlib import load

load()
