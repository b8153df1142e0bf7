"""What one hears: ticks of the wheels and tones of the torque, off at first."""


def test_the_wheels_tick_and_their_torque_is_a_tone(visit, station):
    visitor = visit()
    assert visitor.state()["sound"] == {"on": False, "ticks": 0, "pitch_hz": {}}
    visitor.page.click("#sound")
    # This robot's left wheel rolls forward, the right one backward.
    visitor.until("s.sound.pitch_hz.left > s.sound.pitch_hz.right + 20")
    ticks = visitor.state()["sound"]["ticks"]
    station.step(0.5)
    visitor.until(f"s.sound.ticks > {ticks}")
    station.stop()
    station.step(0.1)
    visitor.until("r.state === 'stopped'")
    visitor.until("Math.abs(s.sound.pitch_hz.left - s.sound.pitch_hz.right) < 1")
    visitor.page.click("#sound")
    assert not visitor.state()["sound"]["on"]
