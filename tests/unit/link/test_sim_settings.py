"""The settings of `sim://`: one table, which the page repeats and the address obeys."""

import re

import pytest

from host.errors import WrongUse
from host.link.addresses import make_link
from host.link.sim_settings import settings
from sim_motor.scene import LIMITS, Scene
from tests.lint.sources import ROOT

PAGE = ROOT / "docs" / "simulated-robot.md"


def cells(row):
    return [cell.strip() for cell in row.strip("|").split("|")]


def test_the_page_has_the_table():
    rows = re.findall(r"^\| `.*$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    said = [(f"`{name}`", *rest) for name, *rest in settings()]
    assert [tuple(cells(row)) for row in rows] == said


def test_it_has_all_fields_of_a_scene():
    assert {*vars(Scene())} < {setting.name for setting in settings()}


@pytest.mark.parametrize("name", LIMITS)
def test_the_ends_of_a_range_are_accepted_and_more_is_refused_with_the_range(name):
    least, most, unit = LIMITS[name]
    walls = "walls=2&" if name in ("across", "stiffness") else ""
    for value in (least, most):
        make_link(f"sim://?{walls}{name}={value}&idle=1", seed=1)
    for value in (least - 0.01, most + 1):
        with pytest.raises(WrongUse, match=re.escape(f"from {least:g} to {most:g} {unit}".strip())):
            make_link(f"sim://?{walls}{name}={value}", seed=1)
