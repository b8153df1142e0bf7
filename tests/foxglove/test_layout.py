"""The layout names only what there is: topics, fields and services."""

import json
import re

import pytest

from host.foxglove.control import Control
from host.foxglove.layout import make_layout, to_text
from host.foxglove.topics import prefixes
from host.logs.messages import EVENTS, SCHEMAS, TICKS
from tests.foxglove.stations import FakeStation

KINDS = {"Plot", "StateTransitions", "RawMessages", "CallService", "Parameters"}


def placed(node):
    """The panels that have a place, in order."""
    if isinstance(node, str):
        return [node]
    assert node["direction"] in ("row", "column")
    assert 0 < node["splitPercentage"] < 100
    return placed(node["first"]) + placed(node["second"])


def paths(node):
    """All message paths, wherever they stand."""
    if isinstance(node, dict):
        for key, value in node.items():
            if key in ("value", "topicPath"):
                yield value
            else:
                yield from paths(value)
    elif isinstance(node, list):
        for one in node:
            yield from paths(one)


@pytest.mark.parametrize("names", [["anna"], ["anna", "tcp://127.0.0.1:5425"]], ids=len)
@pytest.mark.parametrize("control", [False, True])
def test_every_path_and_service_of_the_layout_exists(names, control):
    layout = json.loads(to_text(make_layout(names, control=control)))
    panels = layout["configById"]
    assert sorted(placed(layout["layout"])) == sorted(panels)
    assert {name.partition("!")[0] for name in panels} <= KINDS
    robots = prefixes(names)
    fields = {
        prefix + topic: set(json.loads(schema.data)["properties"])
        for prefix in robots.values()
        for topic, schema in SCHEMAS.items()
    }
    seen = set()
    for path in paths(panels):
        topic, field = re.fullmatch(r"(/[\w/-]+)(?:\.(\w+))?", path).groups()
        assert field is None or field in fields[topic], path
        seen.add(topic)
    assert seen == {prefix + topic for prefix in robots.values() for topic in (TICKS, EVENTS)}
    stations = {prefix: FakeStation(name) for name, prefix in robots.items()}
    offered = {service.name for service in Control(stations).services()}
    called = {one["serviceName"] for one in panels.values() if "serviceName" in one}
    assert called == (offered - {prefix + "/set" for prefix in stations} if control else set())
    for one in panels.values():
        json.loads(one.get("requestPayload", "{}"))
