/** What the page knows, as plain data for tests and for people at the console. */

/**
 * @param {import("./lab.js").Lab} lab
 * @param {import("./stop.js").Stop} stop
 * @param {import("./frames.js").Frames} frames
 * @param {import("./views.js").Views | null} views
 * @param {{state: () => object[]}} kTrace
 * @param {import("./sound.js").Sound} sound
 * @returns {object}
 */
export function snapshot({ store }, stop, frames, views, kTrace, sound) {
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
    const drawing = { frames: frames.count, p95_ms: frames.p95(), shown_s: views?.time ?? null };
    const known = { link, role, page, baton, refused, note, score, poll, selected };
    const shown = { robots, drawing, stop: stop.progress(), k_trace: kTrace.state() };
    return structuredClone({ ...known, ...shown, sound: sound.state() });
}
