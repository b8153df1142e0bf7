"""The rows of a study's table, as a run keeps them."""

import json


def rows_of(study, setting, parts=None):
    """The rows of all cells, or of the cells of some parts, each with its cell's fields."""
    return [
        {**cell, **row}
        for cell in study.cells(setting.options)
        if parts is None or cell["part"] in parts
        for row in json.loads(json.dumps(study.simulate(cell, setting), allow_nan=False))
    ]
