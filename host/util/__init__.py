"""Small tools without a room of their own: angles, intervals, progress, interrupts, provenance."""
