"""The studies that `kickctl theory` runs: cells, rows and reports."""
