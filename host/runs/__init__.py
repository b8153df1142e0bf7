"""Runs: options, cells, folders with results, processes and clusters, claims, reports."""
