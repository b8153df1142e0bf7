"""Small tools for all packages: angles, intervals, progress, interrupts, provenance."""
