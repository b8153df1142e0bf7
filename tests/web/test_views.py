"""What the lab's page lets its drawings show, between two records of a robot."""

from math import cos, pi, sin

import pytest

from tests.web.drawings import open_page

# A robot with two records, 30 ms apart; `shown_s` is the time that is on the screen.
SCRIPT = """
    async ([records, shown_s]) => {
        const { Views } = await import("/views.js");
        const { Ring } = await import("/ring.js");
        const sides = ["left", "right"].flatMap((side) => [
            ...["phi_rad", "x1", "x2", "force", "torque", "duty_pct", "target1", "target2"],
            ...["seen1", "seen2", "omega_rad_s", "lag_rad"],
        ].map((name) => `${side}_${name}`));
        const names = ["tick", "t_s", "kick", "x_m", "y_m", "heading_rad", ...sides];
        const ring = new Ring(names.map((name) => ({ name, code: "d" })), 8);
        records.forEach((record, place) => {
            for (const [name, value] of Object.entries(record)) ring.columns[name][place] = value;
        });
        [ring.length, ring.next] = [records.length, records.length];
        const views = new Views({
            ring,
            kicks: [],
            jumped: {},
            tick_s: 0.03,
            lost: false,
            info: { stall: 0.1, walls: null, track_m: 0.12 },
            playout: { time: () => shown_s },
        });
        views.linked = true;
        views.update(0);
        return views.wheels.left;
    }
"""


@pytest.fixture(scope="module")
def page(browser):
    """A page that has the lab's scripts."""
    page = open_page(browser)
    yield page
    page.close()


@pytest.mark.parametrize("shift", [0.0, 3 * pi / 4])
def test_seen_positions_turn_with_the_wheel_between_records(page, shift):
    records = [
        {
            "t_s": 0.03 * number,
            "tick": number,
            "kick": 1,
            "left_phi_rad": 0.4 * number,
            "left_seen1": cos(0.4 * number + shift),
            "left_seen2": sin(0.4 * number + shift),
        }
        for number in range(2)
    ]
    wheel = page.evaluate(SCRIPT, [records, 0.015])
    assert wheel["phi_rad"] == pytest.approx(0.2)
    assert wheel["seen1"] == pytest.approx(cos(0.2 + shift))
    assert wheel["seen2"] == pytest.approx(sin(0.2 + shift))
