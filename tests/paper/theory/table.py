"""The rows of a study's tables, as a run keeps them."""

import json

from host.runs.columns import by_kind, kinds_of


def rows_of(study, setting, parts=None):
    """The rows of all cells, or of the cells of some parts, each with its cell's fields.

    The data dictionary has all their columns.
    """
    found = [
        {**cell, **row}
        for cell in study.cells(setting.options)
        if parts is None or cell["part"] in parts
        for row in json.loads(json.dumps(study.simulate(cell, setting), allow_nan=False))
    ]
    assert sum(map(len, by_kind(found, kinds_of(study)).values())) == len(found)
    return found
