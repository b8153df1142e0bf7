/**
 * The robot on the floor, seen from above: its path by odometry, its outline with its heading, a
 * grid in metres, and the walls of a simulated one.
 */

// The view holds the path with this room around it, m, and becomes narrower only if the path needs
// less than this part of it.
const ROOM_M = 0.25;
const NARROW = 0.4;
const SPANS_M = [1, 1.5, 2, 3, 5, 7, 10, 15, 20, 30, 50, 70, 100, 200, 500, 1000];
// How many points are drawn in one go: Chromium paints long paths slowly.
const PIECE = 64;
// Outline of the robot, in tracks: ahead of and behind its axle.
const AHEAD = 0.75;
const BACK = 0.5;

/**
 * @typedef {Object} FloorState
 * @property {Float64Array|Float32Array} x_m ring: where the robot was, m
 * @property {Float64Array|Float32Array} y_m ring, m
 * @property {Float64Array|Float32Array} heading_rad ring: where it pointed, rad; 0 along x
 * @property {number} start index of the oldest record in the rings
 * @property {number} count how many records to draw
 * @property {?number} walls distance between two walls, m, halfway between them the robot began;
 *     null if there are none
 * @property {?number} track_m distance between the wheels, m
 * @property {Object} view an object that the drawing keeps its view in, so that it does not jitter;
 *     {} at first
 * @property {boolean} stale whether this is no longer up to date
 * @property {{start: string}} labels words: 'start'
 */

/**
 * Draw the floor.
 *
 * @param {HTMLCanvasElement} canvas its width and height are device pixels
 * @param {FloorState} state what is not known may be missing or NaN
 * @param {Object} theme see theme.js
 */
export function draw(canvas, state, theme) {
    const { ctx, width, height, colours } = theme.start(canvas, state.stale);
    const least = Math.min(width, height);
    const view = look(state, width / least, height / least);
    const unit = least / view.span;
    const x = (metres) => width / 2 + (metres - view.x) * unit;
    const y = (metres) => height / 2 - (metres - view.y) * unit;
    const sheet = { ctx, colours, theme, width, height, unit, x, y, view };
    grid(sheet);
    if (state.walls > 0) walls(sheet, state.walls);
    trail(sheet, state);
    robot(sheet, state);
    bar(sheet);
}

/**
 * What is in view: its middle and its shorter side, m; wide and high are the sides in shorter ones.
 * It changes seldom, and by steps.
 */
function look(state, wide, high) {
    const { x_m: xs, y_m: ys, start = 0, count = 0, walls = null } = state;
    const half = walls > 0 ? walls / 2 : 0;
    let [west, east, south, north] = [-half, half, 0, 0];
    for (let n = 0; n < count && xs && ys; n++) {
        const index = (start + n) % xs.length;
        if (xs[index] < west) west = xs[index];
        if (xs[index] > east) east = xs[index];
        if (ys[index] < south) south = ys[index];
        if (ys[index] > north) north = ys[index];
    }
    const need = Math.max((east - west) / wide, (north - south) / high) + 2 * ROOM_M;
    const view = state.view ?? {};
    const across = (view.span * wide - ROOM_M) / 2;
    const along = (view.span * high - ROOM_M) / 2;
    const fits =
        view.x - across <= west && east <= view.x + across &&
        view.y - along <= south && north <= view.y + along;
    if (fits && need >= NARROW * view.span) return view;
    view.span = SPANS_M.find((span) => span >= need) ?? need;
    const step = view.span / 20;
    view.x = Math.round((west + east) / 2 / step) * step;
    view.y = Math.round((south + north) / 2 / step) * step;
    return view;
}

function grid({ ctx, colours, width, height, unit, x, y, view, theme }) {
    const step = theme.ticks(0, view.span, 8)[1] ?? 1;
    const [wide, high] = [width / unit / 2, height / unit / 2];
    ctx.fillStyle = colours.grid;
    for (let n = Math.ceil((view.x - wide) / step); n * step <= view.x + wide; n++) {
        ctx.fillRect(x(n * step) - 0.5, 0, 1, height);
    }
    for (let n = Math.ceil((view.y - high) / step); n * step <= view.y + high; n++) {
        ctx.fillRect(0, y(n * step) - 0.5, width, 1);
    }
}

function walls({ ctx, colours, theme, x, height }, distance) {
    for (const side of [-1, 1]) {
        const edge = x((side * distance) / 2);
        const thick = side * 0.6 * theme.text;
        ctx.fillStyle = colours.band;
        ctx.fillRect(Math.min(edge, edge + thick), 0, Math.abs(thick), height);
        ctx.fillStyle = colours.ink;
        ctx.fillRect(edge - theme.line / 2, 0, theme.line, height);
    }
}

function trail({ ctx, colours, theme, x, y }, state) {
    const { x_m: xs, y_m: ys, start = 0, count = 0 } = state;
    if (!xs || !ys) return;
    let [px, py, points] = [NaN, NaN, 0];
    ctx.strokeStyle = colours.right1;
    ctx.lineWidth = theme.line;
    ctx.beginPath();
    for (let n = 0; n < count; n++) {
        const index = (start + n) % xs.length;
        const [at, up] = [x(xs[index]), y(ys[index])];
        // What is nearer than a pixel is the same place.
        if (Math.abs(at - px) + Math.abs(up - py) < 1 && n < count - 1) continue;
        if (!Number.isNaN(px + py)) ctx.lineTo(at, up);
        if (++points % PIECE === 0 || Number.isNaN(px + py)) {
            ctx.stroke();
            ctx.beginPath();
            ctx.moveTo(at, up);
        }
        [px, py] = [at, up];
    }
    ctx.stroke();
    ctx.beginPath();
    ctx.arc(x(0), y(0), 0.3 * theme.text, 0, 2 * Math.PI);
    ctx.strokeStyle = colours.faint;
    ctx.stroke();
    const how = { colour: colours.faint, size: 0.85, halo: colours.paper };
    theme.write(ctx, state.labels?.start ?? "", x(0) + 0.3 * theme.text, y(0) + theme.text, how);
}

function robot({ ctx, colours, theme, unit, x, y }, state) {
    const { x_m: xs, y_m: ys, heading_rad: headings, start = 0, count = 0 } = state;
    if (!xs || !ys || !headings || !(count > 0)) return;
    const index = (start + count - 1) % xs.length;
    if (!Number.isFinite(xs[index] + ys[index] + headings[index])) return;
    // A robot that is too small to see is drawn larger.
    const track = Math.max((state.track_m || 0.12) * unit, 2 * theme.text);
    ctx.save();
    ctx.translate(x(xs[index]), y(ys[index]));
    ctx.rotate(-headings[index]);
    ctx.lineWidth = theme.line;
    ctx.strokeStyle = colours.ink;
    ctx.fillStyle = colours.rim;
    ctx.beginPath();
    ctx.moveTo(-BACK * track, -0.4 * track);
    ctx.lineTo(0.4 * track, -0.4 * track);
    ctx.lineTo(AHEAD * track, 0);
    ctx.lineTo(0.4 * track, 0.4 * track);
    ctx.lineTo(-BACK * track, 0.4 * track);
    ctx.closePath();
    ctx.fill();
    ctx.stroke();
    ctx.fillStyle = colours.ink;
    for (const side of [-0.5, 0.5]) {
        ctx.fillRect(-0.22 * track, (side - 0.08) * track, 0.44 * track, 0.16 * track);
    }
    ctx.fillStyle = colours.actual;
    ctx.beginPath();
    ctx.arc(0.35 * track, 0, 0.13 * track, 0, 2 * Math.PI);
    ctx.fill();
    ctx.restore();
}

/** How long a metre is, or what is round and fits. */
function bar({ ctx, colours, theme, height, unit, view }) {
    const step = theme.ticks(0, view.span, 8)[1] ?? 1;
    const [left, y] = [theme.text, height - theme.text];
    ctx.fillStyle = colours.ink;
    ctx.fillRect(left, y, step * unit, theme.line);
    const how = { colour: colours.ink, size: 0.9, halo: colours.paper };
    const digits = step < 1 ? 1 : 0;
    theme.write(ctx, theme.number(step, digits) + " m", left, y - 0.8 * theme.text, how);
}
