/**
 * A wheel with its two simulated transmission rods, as in the paper's figure of the actuator.
 *
 * Forward is counterclockwise. The first rod lies right of the wheel, the second one below it. On
 * each rail, a spring lies between the target position (green square) and the actual position
 * (orange circle). The arrow at the rim is the tangential force; its length is |M|. The diamond
 * inside is what the neurons remember, (x1, x2). Hollow dashed circles are the positions that a
 * quenched kick shows to the neurons.
 */

// In radii of the wheel: from the axle to the middle of a rail, from a rail to its spring and to
// its scale, and what is drawn left of and right of the axle.
const RAIL = 2.55;
const SPRING = 0.36;
const SCALE = 0.68;
const BEFORE = 1.45;
const BEHIND = 3.9;
const COILS = 6;
// How long the arc is that shows the speed, rad for each rad/s.
const ARC_S = 0.09;
const LONGEST_ARC = 1.9;

/**
 * @typedef {Object} WheelState
 * @property {number} phi_rad the wheel's angle, rad
 * @property {number} x1 first membrane potential, 1
 * @property {number} x2 second membrane potential, 1
 * @property {number} target1 where the first neuron wants its rod, 1
 * @property {number} target2 where the second neuron wants its rod, 1
 * @property {number} seen1 first position that the neurons see, 1
 * @property {number} seen2 second position that the neurons see, 1
 * @property {number} force F_tan, 1
 * @property {number} torque M, 1
 * @property {number} omega_rad_s angular velocity, rad/s
 * @property {number} duty_pct duty cycle of the motor, %
 * @property {?number} stall the least |M| that moves the wheel from rest, 1; null if unknown
 * @property {string} kick the name of the kick that acts now, for people; empty if none does
 * @property {string} title the wheel's name, for people
 * @property {boolean} stale whether this is no longer up to date
 * @property {{forward: string, backward: string, rest: string, duty: string, turns: string,
 *     stall: string}} labels words: 'forward', 'backward', 'at rest', 'duty', 'turns/s', 'stalls'
 */

/**
 * Where the wheel is on its canvas.
 *
 * @param {HTMLCanvasElement} canvas the drawing's
 * @param {Object} theme see theme.js
 * @returns {{x: number, y: number, radius: number, rail: number, spring: number}} the axle and the
 *     wheel's radius, CSS pixels; then in radii, from the axle to the middle of a rail, and from a
 *     rail aside to the line of its spring and target
 */
export function layout(canvas, theme) {
    const width = canvas.width / theme.scale;
    const height = canvas.height / theme.scale;
    const extent = BEFORE + BEHIND;
    const radius = Math.min(width, height) / extent;
    return {
        x: (width - extent * radius) / 2 + BEFORE * radius,
        y: (height - extent * radius) / 2 + BEFORE * radius,
        radius,
        rail: RAIL,
        spring: SPRING,
    };
}

/**
 * The wheel's angle at which its pin is nearest to a point.
 *
 * @param {HTMLCanvasElement} canvas the drawing's
 * @param {Object} theme see theme.js
 * @param {number} x from the canvas's left edge, CSS pixels
 * @param {number} y from its upper edge, CSS pixels
 * @returns {?number} rad, from -pi to pi; null if the point is beside the wheel
 */
export function angleAt(canvas, theme, x, y) {
    const at = layout(canvas, theme);
    const right = (x - at.x) / at.radius;
    const up = (at.y - y) / at.radius;
    return Math.hypot(right, up) > 1.2 ? null : Math.atan2(up, right);
}

/**
 * Draw a wheel.
 *
 * @param {HTMLCanvasElement} canvas its width and height are device pixels
 * @param {WheelState} state what is not known may be missing or NaN
 * @param {Object} theme see theme.js
 */
export function draw(canvas, state, theme) {
    const { ctx, width, height, colours } = theme.start(canvas, state.stale);
    const at = layout(canvas, theme);
    const pen = { ctx, colours, theme, radius: at.radius, line: theme.line };
    const known = Number.isFinite(state.phi_rad);
    const pin = known ? [Math.cos(state.phi_rad), Math.sin(state.phi_rad)] : [NaN, NaN];
    const seen = ghost(state, pin);
    ctx.save();
    ctx.translate(at.x, at.y);
    ctx.scale(at.radius, -at.radius);
    disc(pen);
    scales(pen);
    if (known) {
        spokes(pen, state, pin);
        rods(pen, state, pin);
        if (seen) ghosts(pen, seen);
        force(pen, state, pin);
    }
    ctx.restore();
    directions(pen, at, state);
    readout(pen, at, state, width, height);
    if (state.kick) {
        ctx.strokeStyle = colours.kick;
        ctx.lineWidth = 2 * theme.line;
        ctx.strokeRect(theme.line, theme.line, width - 2 * theme.line, height - 2 * theme.line);
    }
}

/** The seen positions if they are other than the actual ones, else null. */
function ghost(state, pin) {
    if (!state.kick || !Number.isFinite(state.seen1 + state.seen2)) return null;
    const away = Math.hypot(state.seen1 - pin[0], state.seen2 - pin[1]);
    return away > 1e-3 ? [state.seen1, state.seen2] : null;
}

/** Set the pen for a line of a width in CSS pixels, while the unit is the wheel's radius. */
function stroke({ ctx, radius }, colour, width) {
    ctx.strokeStyle = colour;
    ctx.lineWidth = width / radius;
    ctx.stroke();
}

function circle(ctx, x, y, r) {
    ctx.beginPath();
    ctx.arc(x, y, r, 0, 2 * Math.PI);
}

function path(ctx, ...points) {
    ctx.beginPath();
    for (const [x, y] of points) ctx.lineTo(x, y);
}

/** A point on or beside a rail: the first one lies right of the wheel, the second one below it. */
function place(rod, along, aside) {
    return rod === 0 ? [RAIL + along, -aside] : [aside, along - RAIL];
}

function disc(pen) {
    const { ctx, colours, line } = pen;
    circle(ctx, 0, 0, 1.1);
    ctx.fillStyle = colours.rim;
    ctx.fill();
    stroke(pen, colours.ink, 1.6 * line);
    circle(ctx, 0, 0, 1);
    stroke(pen, colours.axis, 0.5 * line);
}

function scales(pen) {
    const { ctx, colours, theme, radius, line } = pen;
    for (const rod of [0, 1]) {
        path(ctx, place(rod, -1, SCALE), place(rod, 1, SCALE));
        for (const value of [-1, 0, 1]) {
            ctx.moveTo(...place(rod, value, SCALE));
            ctx.lineTo(...place(rod, value, SCALE + 0.08));
        }
        stroke(pen, colours.axis, 0.6 * line);
        ctx.save();
        ctx.scale(1 / radius, -1 / radius);
        for (const value of [-1, 0, 1]) {
            const [x, y] = place(rod, value, SCALE + 0.12);
            const how = { colour: colours.faint, size: 0.85, align: rod ? "left" : "center" };
            const below = rod ? 0 : 0.5 * theme.text;
            theme.write(ctx, theme.number(value), x * radius, below - y * radius, how);
        }
        ctx.restore();
    }
}

function spokes(pen, state, pin) {
    const { ctx, colours, line } = pen;
    for (const turn of [1, 2]) {
        const angle = state.phi_rad + (turn * 2 * Math.PI) / 3;
        path(ctx, [0, 0], [Math.cos(angle), Math.sin(angle)]);
        stroke(pen, colours.axis, 0.6 * line);
    }
    path(ctx, [0, 0], pin);
    stroke(pen, colours.ink, 1.2 * line);
    circle(ctx, 0, 0, 0.12);
    ctx.fillStyle = colours.ink;
    ctx.fill();
    const reach = Math.hypot(state.x1, state.x2);
    if (!Number.isFinite(reach)) return;
    const short = Math.min(1, 1.35 / reach);
    const [x, y] = [state.x1 * short, state.x2 * short];
    path(ctx, [0, 0], [x, y]);
    stroke(pen, colours.memory, line);
    path(ctx, [x - 0.09, y], [x, y - 0.09], [x + 0.09, y], [x, y + 0.09]);
    ctx.closePath();
    ctx.fillStyle = colours.memory;
    ctx.fill();
}

function rods(pen, state, pin) {
    const { ctx, colours, radius, line } = pen;
    const dot = Math.max(0.12, 4.5 / radius);
    for (const rod of [0, 1]) {
        const actual = pin[rod];
        const target = rod ? state.target2 : state.target1;
        const head = place(rod, actual, 0);
        path(ctx, pin, head);
        stroke(pen, colours.rod, 3 * line);
        path(ctx, head, place(rod, actual, SPRING));
        stroke(pen, colours.actual, 1.6 * line);
        if (Number.isFinite(target)) {
            spring(ctx, rod, actual, target);
            stroke(pen, colours.ink, 0.7 * line);
            const [x, y] = place(rod, target, SPRING);
            ctx.fillStyle = colours.target;
            ctx.fillRect(x - dot, y - dot, 2 * dot, 2 * dot);
        }
        circle(ctx, ...head, dot);
        ctx.fillStyle = colours.actual;
        ctx.fill();
        stroke(pen, colours.paper, 0.5 * line);
    }
    circle(ctx, ...pin, dot);
    ctx.fillStyle = colours.actual;
    ctx.fill();
    stroke(pen, colours.ink, 0.7 * line);
}

function spring(ctx, rod, begin, end) {
    ctx.beginPath();
    const half = 2 * COILS;
    for (let n = 0; n <= half; n++) {
        const aside = n % half ? (n % 2 ? 0.1 : -0.1) : 0;
        ctx.lineTo(...place(rod, begin + ((end - begin) * n) / half, SPRING + aside));
    }
}

function ghosts(pen, seen) {
    const { ctx, colours, radius, line } = pen;
    const dot = Math.max(0.16, 6 / radius);
    ctx.setLineDash([0.08, 0.07]);
    ctx.lineCap = "butt";
    path(ctx, [0, 0], seen);
    stroke(pen, colours.actual, line);
    for (const [x, y] of [seen, place(0, seen[0], 0), place(1, seen[1], 0)]) {
        circle(ctx, x, y, dot);
        stroke(pen, colours.actual, 1.4 * line);
    }
    ctx.setLineDash([]);
    ctx.lineCap = "round";
}

/** A line to a tip at (x, y) with a head that points along (right, up), a unit vector. */
function arrowHead(ctx, x, y, right, up, size) {
    path(
        ctx,
        [x, y],
        [x - size * (right + up / 2), y - size * (up - right / 2)],
        [x - size * (right - up / 2), y - size * (up + right / 2)],
    );
    ctx.closePath();
}

function force(pen, state, pin) {
    const { ctx, colours, radius, line } = pen;
    const length = state.torque;
    if (!Number.isFinite(length) || Math.abs(length) < 0.01) return;
    const [right, up] = [-pin[1] * Math.sign(length), pin[0] * Math.sign(length)];
    const tip = [pin[0] - pin[1] * length, pin[1] + pin[0] * length];
    const size = Math.min(Math.max(0.2, 8 / radius), Math.abs(length));
    path(ctx, pin, [tip[0] - right * size * 0.8, tip[1] - up * size * 0.8]);
    stroke(pen, colours.force, 2.2 * line);
    arrowHead(ctx, ...tip, right, up, size);
    ctx.fillStyle = colours.force;
    ctx.fill();
}

/** Outside the rim: which way is forward, and how the wheel turns now. */
function directions(pen, at, state) {
    const { ctx, colours, theme, line } = pen;
    const words = state.labels ?? {};
    const arc = (from, to, colour, width) => {
        const r = 1.26 * at.radius;
        const way = Math.sign(to - from);
        const size = 4 * theme.line;
        const end = to - (way * size) / r;
        ctx.beginPath();
        ctx.arc(at.x, at.y, r, -from, -end, way > 0);
        ctx.strokeStyle = colour;
        ctx.lineWidth = width;
        ctx.stroke();
        const [c, s] = [Math.cos(to), Math.sin(to)];
        arrowHead(ctx, at.x + r * c, at.y - r * s, -s * way, -c * way, size);
        ctx.fillStyle = colour;
        ctx.fill();
    };
    arc(3.5, 4.15, colours.axis, 0.8 * line);
    const low = at.y + 1.5 * at.radius;
    theme.write(ctx, words.forward ?? "", at.x - 1.4 * at.radius, low, { colour: colours.faint });
    const sweep = state.omega_rad_s * ARC_S;
    if (Math.abs(sweep) > 0.05) {
        const half = Math.max(-LONGEST_ARC, Math.min(LONGEST_ARC, sweep)) / 2;
        arc(Math.PI / 2 - half, Math.PI / 2 + half, colours.ink, 1.6 * line);
    }
}

/** The numbers, right below where the picture is empty. */
function readout(pen, at, state, width, height) {
    const { ctx, colours, theme } = pen;
    const words = state.labels ?? {};
    const left = at.x + 1.15 * at.radius;
    const step = 1.45 * theme.text;
    const room = Math.min(width - left - theme.text / 2, 15 * theme.text);
    let y = at.y + 1.5 * at.radius;
    const line = (symbol, value, unit, colour, bold) => {
        if (y > height - theme.text * 0.7) return;
        theme.write(ctx, symbol, left, y, { colour, symbol: symbol.length === 1, bold });
        const numbers = left + 4.6 * theme.text;
        theme.write(ctx, value, numbers, y, { colour, align: "right", bold });
        theme.write(ctx, unit, numbers + 0.4 * theme.text, y, { colour: colours.faint });
        y += step;
    };
    theme.write(ctx, state.title ?? "", left, y, { colour: colours.ink, bold: true });
    y += step;
    line("M", theme.number(state.torque, 2, true), "", colours.force, true);
    gauge(pen, left, y - 0.2 * step, room, state);
    y += 0.7 * step;
    line("ω", theme.number(state.omega_rad_s, 1, true), "rad/s", colours.ink);
    line("", theme.number(state.omega_rad_s / 2 / Math.PI, 1, true), words.turns, colours.ink);
    line(words.duty ?? "", theme.number(state.duty_pct, 0, true), "%", colours.ink);
    if (!state.kick) return;
    const below = Math.min(y, height - 0.9 * step);
    ctx.fillStyle = colours.kick;
    ctx.fillRect(left - 0.3 * theme.text, below - 0.65 * step, room + 0.3 * theme.text, 1.2 * step);
    theme.write(ctx, state.kick, left, below, { colour: colours.paper, bold: true });
}

/** M between -1 and 1, with the band in which the wheel does not start. */
function gauge({ ctx, colours, theme }, left, y, room, state) {
    const width = room;
    const half = 0.32 * theme.text;
    const x = (value) => left + ((value + 1) / 2) * width;
    ctx.fillStyle = colours.rim;
    ctx.fillRect(left, y - half, width, 2 * half);
    if (state.stall > 0) {
        ctx.fillStyle = colours.band;
        ctx.fillRect(x(-state.stall), y - half, x(state.stall) - x(-state.stall), 2 * half);
        ctx.fillStyle = colours.axis;
        ctx.fillRect(x(-state.stall), y - half, 1, 2 * half);
        ctx.fillRect(x(state.stall), y - half, 1, 2 * half);
    }
    if (!Number.isFinite(state.torque)) return;
    ctx.fillStyle = colours.force;
    const [from, to] = [x(Math.min(0, state.torque)), x(Math.max(0, state.torque))];
    ctx.fillRect(from, y - half / 2, to - from, half);
    ctx.fillRect(x(state.torque) - theme.line, y - 1.6 * half, 2 * theme.line, 3.2 * half);
}
