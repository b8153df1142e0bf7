"""The texts of the guided exercises, as pages get them."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path
from typing import Any

_FILE = Path(__file__).with_name("lessons.toml")


@cache
def lessons() -> tuple[dict[str, Any], ...]:
    """The exercises in their order: the fields that lessons.toml explains."""
    return tuple(tomllib.loads(_FILE.read_text("utf-8"))["lesson"])
