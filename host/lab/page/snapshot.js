/** What the page knows, as plain data for tests and for people at the console. */

/**
 * @param {object} parts Of the page: its `lab`, `stop`, `frames`, `kTrace`, `sound` and `beside`,
 *     and the `views` of the robot that is shown, or null.
 * @returns {object}
 */
export function snapshot({ lab, stop, frames, views, kTrace, sound, beside }) {
    const { store } = lab;
    const { link, role, page, baton, refused, note, score, poll, selected } = store;
    const robots = store.robots.map((robot) => ({
        name: robot.name,
        state: robot.state,
        lost: robot.lost,
        status: robot.status,
        record: robot.ring.record(),
        records: robot.ring.length,
        missed: robot.missed,
        kicks: robot.kicks,
        basins: robot.basins,
    }));
    const twins = store.twins.map(({ name, robot, ring, compared, score, info }) => ({
        name,
        robot: robot.name,
        record: ring.record(),
        records: ring.length,
        compared,
        score,
        why: info.why,
    }));
    const drawing = {
        frames: frames.count,
        p95_ms: frames.p95(),
        shown_s: views?.time ?? null,
        due: lab.changed,
    };
    const known = { link, role, page, baton, refused, note, score, poll, selected };
    const shown = { robots, twins, drawing, stop: stop.progress(), k_trace: kTrace.state() };
    const parts = { sound: sound.state(), beside: beside.state() };
    return structuredClone({ ...known, ...shown, ...parts });
}
