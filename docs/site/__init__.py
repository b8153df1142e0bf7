"""Builds the site of these pages; `make docs` calls it."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
