"""Figures, one file each; matplotlib is loaded when one is drawn, and needs no display."""
