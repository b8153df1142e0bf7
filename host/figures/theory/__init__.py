"""Figures of the analytic model."""
