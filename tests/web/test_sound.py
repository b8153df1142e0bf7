"""What one hears: ticks of the wheels and tones of the torque, off at first."""

from itertools import pairwise

import pytest


def test_the_wheels_tick_and_their_torque_is_a_tone(visit, station):
    visitor = visit()
    assert visitor.state()["sound"] == {"on": False, "ticks": 0, "pitch_hz": {}, "sounds": {}}
    visitor.page.click("#sound")
    # This robot's left wheel rolls forward, the right one backward.
    visitor.until("s.sound.pitch_hz.left > s.sound.pitch_hz.right + 20")
    ticks = visitor.state()["sound"]["ticks"]
    station.step(0.5)
    visitor.until(f"s.sound.ticks > {ticks} && s.sound.sounds.left")
    visitor.page.fill("#param-k", "0.1")
    visitor.page.keyboard.press("Enter")
    visitor.until("r.status.params.k === 0.1")
    station.step(3)
    visitor.until("r.state === 'running' && !s.sound.sounds.left && !s.sound.sounds.right")
    ticks = visitor.state()["sound"]["ticks"]
    station.step(1)
    visitor.until("r.records > 0")
    assert visitor.state()["sound"]["ticks"] == ticks  # a wheel at rest is silent
    station.stop()
    station.step(0.1)
    visitor.until("r.state === 'stopped'")
    visitor.until("Math.abs(s.sound.pitch_hz.left - s.sound.pitch_hz.right) < 1")
    visitor.page.click("#sound")
    assert not visitor.state()["sound"]["on"]


# Frames at 60 a second, a sound's clock that moves in steps of 20 ms, and a wheel with two turns a
# second. Returns when its clicks begin, s.
CLICKS = """async () => {
    const starts = [];
    let now = 0;
    class Context extends OfflineAudioContext {
        constructor() { super(2, 44100, 44100); }
        get currentTime() { return now; }
        resume() {}
    }
    class Oscillator extends OscillatorNode {
        start(when) { if (this.type === "square") starts.push(when); }
        stop() {}
    }
    Object.assign(window, { AudioContext: Context, OscillatorNode: Oscillator });
    const { Sound } = await import("/sound.js");
    const button = document.createElement("button");
    const sound = new Sound(button);
    button.onclick();
    const robot = { state: "running", info: { stall: 0.1 } };
    const right = { phi_rad: 0, torque: 0 };
    for (let time = 0; time < 5; time += 1 / 60) {
        now = Math.floor(time / 0.02) * 0.02;
        const left = { phi_rad: 4 * Math.PI * time, torque: 1 };
        sound.update({ stale: false, time, robot, wheels: { left, right } });
    }
    return starts;
}"""


def test_a_wheel_that_rolls_evenly_clicks_evenly(visit):
    starts = visit().page.evaluate(CLICKS)
    assert len(starts) == 79
    gaps = [after - before for before, after in pairwise(starts[10:])]
    assert gaps == pytest.approx([1 / 16] * len(gaps), abs=0.003)
