"""What moving k by hand leaves: one mark for each k that was held, raised or lowered."""

import pytest

from tests.web.drawings import open_page

# A robot on which k is moved: (k, seconds, speed, torque, state, a) after each other. The speed's
# sign changes with each record, and the right wheel is twice as fast as the left one.
SCRIPT = """
    async ([steps, clear]) => {
        const { KTrace } = await import("/k_trace.js");
        const { Ring } = await import("/ring.js");
        const names = ["t_s"];
        for (const side of ["left", "right"]) names.push(`${side}_omega_rad_s`, `${side}_torque`);
        const ring = new Ring(names.map((name) => ({ name, code: "d" })), 256);
        const robot = { ring, state: "running", status: { params: {} } };
        const trace = new KTrace(robot);
        trace.update();
        let now = 0;
        for (const [k, seconds, speed, torque, state = "running", a = 4] of steps) {
            Object.assign(robot, { state, status: { params: { k, a } } });
            trace.update();
            for (let n = 0; n < Math.round(seconds / 0.03); n += 1) {
                now += 0.03;
                const sign = n % 2 ? 1 : -1;
                const values = [now, sign * speed, torque, 2 * sign * speed, sign * torque];
                const data = new DataView(new ArrayBuffer(40));
                values.forEach((value, place) => data.setFloat64(8 * place, value, true));
                ring.push(data, 0);
                trace.update();
            }
        }
        if (clear) trace.clear();
        return trace.holds.map(({ k, up, means }) => [k, up, means.left, means.right]);
    }
"""


def means(omega_rad_s, torque):
    return pytest.approx({"omega_rad_s": omega_rad_s, "torque": torque})


@pytest.fixture(scope="module")
def page(browser):
    page = open_page(browser)
    yield page
    page.close()


def test_each_k_that_was_held_has_a_mark(page):
    steps = [(8, 2, 5, 0.5), (2, 1, 9, 1), (2, 2, 3, 0.25), (5, 0.5, 9, 1), (4, 2, 4, 0.3)]
    assert page.evaluate(SCRIPT, [steps, False]) == [
        [8, None, means(5, 0.5), means(10, 0.5)],
        [2, False, means(3, 0.25), means(6, 0.25)],  # of its last second
        [4, False, means(4, 0.3), means(8, 0.3)],  # 5 was not held
    ]
    assert page.evaluate(SCRIPT, [steps[:3], True]) == [[2, None, means(3, 0.25), means(6, 0.25)]]


def test_another_gain_begins_a_new_trace(page):
    steps = [(8, 2, 5, 0.5), (2, 2, 3, 0.25), (2, 2, 1, 0.1, "running", 2)]
    assert page.evaluate(SCRIPT, [steps, False]) == [[2, None, means(1, 0.1), means(2, 0.1)]]


def test_a_robot_that_does_not_run_leaves_no_mark(page):
    steps = [(8, 2, 5, 0.5), (9, 2, 0, 0, "stopped"), (9, 0.5, 5, 0.5)]
    assert page.evaluate(SCRIPT, [steps, False])[1:] == [[9, True, None, None]]
