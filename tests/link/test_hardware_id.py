"""A robot says which machine it is on: to anybody, and only where the machine has a number."""

from tests.rig import Rig
from tests.talk import Client


def test_anybody_hears_the_hardware_id_without_a_token(monkeypatch):
    monkeypatch.setattr("robot.session._HARDWARE_ID", "a" * 32)
    assert Client(Rig().loop, None).greet().talk.hello["hardware_id"] == "a" * 32


def test_a_machine_without_a_number_leaves_it_out(monkeypatch):
    monkeypatch.setattr("robot.session._HARDWARE_ID", "")
    assert "hardware_id" not in Client(Rig().loop).greet().talk.hello
