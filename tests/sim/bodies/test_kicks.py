"""Kicks of a body at set times, read from words."""

from math import pi

import numpy as np
import pytest

from host.bodies.build import BodyRequest, build_body
from host.bodies.kicks import parse_kick, run_with_kicks
from host.errors import NotDone, WrongUse


def test_words_make_kicks_of_wheels_and_wrong_words_are_refused():
    wheels = ("car0_left", "car0_right", "car1_left", "car1_right")
    assert parse_kick("t=5,mode=membrane,wheel=all", wheels).wheels == wheels
    assert parse_kick("t=5,mode=membrane,wheel=left", wheels).wheels == ("car0_left", "car1_left")
    spaced = parse_kick("t=1, mode=phase, wheel=car1, shift=-pi/2, seconds=0.2", wheels)
    assert spaced.wheels == ("car1_left", "car1_right")
    scheduled = parse_kick("t=1,mode=phase,wheel=car1_left,seconds=0.2", wheels)
    (kick,) = scheduled.kicks(1000, 0.001, [-3.0])
    assert (kick.begin, kick.ticks, kick.wheels) == (1000, 200, ("car1_left",))
    assert kick.values[0] == -3 * pi / 4
    for words, reason in (
        ("mode=phase", "time"),
        ("t=1,mode=phase,wheel=car7", "car7"),
        ("t=1,mode=shout", "mode"),
        ("t=1,mode=membrane,seconds=3", "membrane"),
        ("t=x,mode=phase", "t of a kick"),
        ("t=1,colour=red", "colour"),
        ("t=nan,mode=phase", "time"),
        ("t=1,mode=phase,shift=100", "shift"),
        ("t=1,mode=phase,shift=foo", "shift"),
        ("t=1,mode=phase,seconds=-1", "last"),
        ("t=1,t=2,mode=phase", "more than one t"),
    ):
        with pytest.raises(WrongUse, match=reason):
            parse_kick(words, wheels)


def test_scheduled_kicks_begin_at_their_times_in_any_order_and_only_on_their_wheels():
    body = build_body(BodyRequest(cars=2))
    given, body.kick = [], lambda kick: given.append((body.step, kick.begin, kick.wheels))
    later, sooner = (
        parse_kick(words, body.wheels)
        for words in ("t=0.3,mode=membrane,wheel=car1", "t=0.1,mode=phase,wheel=car0_right")
    )
    times_s = []
    run_with_kicks(body, 0.5, [later, sooner], times_s.append)
    assert given == [
        (100, 100, ("car0_right",)),
        (300, 300, ("car1_left",)),
        (300, 300, ("car1_right",)),
    ]
    assert times_s[-1] == pytest.approx(0.5)


def test_a_body_that_cannot_be_followed_says_so_and_keeps_what_there_was():
    body = build_body(BodyRequest(cars=5, k=1e9))
    with pytest.raises(NotDone, match="cannot be followed"):
        run_with_kicks(body, 5.0, [], lambda time_s: None)
    assert 0.0 < body.time_s < 5.0
    assert np.isfinite(body.rows).all()
