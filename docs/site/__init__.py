"""Builds the site of these pages; `make docs` calls it."""
