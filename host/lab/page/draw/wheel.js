/**
 * A wheel with its two simulated transmission rods, as in the paper's figure of the actuator.
 *
 * Forward is counterclockwise. The first rod lies right of the wheel, the second one below it. On
 * each rail, a spring lies between the target position (green square) and the actual position
 * (orange circle). The arrow at the rim is the paper's tangential force, and its length is |M|; the
 * paper's sign is opposite to the pull of springs that lie like this. The diamond inside is what
 * the neurons remember, (x1, x2). Hollow dashed circles are what a quenched kick shows to them.
 */

// In radii of the wheel: from the axle to the middle of a rail, from a rail aside to its spring and
// to its scale, and what is drawn before and behind the axle.
export const RAIL = 2.55;
export const SPRING = 0.36;
const SCALE = 0.68;
const [BEFORE, BEHIND] = [1.45, 4];
const COILS = 6;
// The arc that shows the speed: its length in rad for each rad/s, and at most, rad.
const ARC_S = 0.09;
const LONGEST_ARC = 1.9;
// Seen positions that are no farther from the actual ones than this are the actual ones, rounded.
const ROUNDING = 1e-3;

/**
 * @typedef {Object} WheelState
 * @property {number} phi_rad the wheel's angle, rad
 * @property {number} x1 first membrane potential, 1
 * @property {number} x2 second membrane potential, 1
 * @property {number} target1 where the first neuron wants its rod, 1
 * @property {number} target2 where the second neuron wants its rod, 1
 * @property {number} seen1 first position that the neurons see, 1
 * @property {number} seen2 second position that the neurons see, 1
 * @property {number} torque M, 1; missing for a wheel without a motor, as is duty_pct
 * @property {number} omega_rad_s angular velocity, rad/s
 * @property {number} duty_pct duty cycle of the motor, %
 * @property {?number} stall the least |M| that moves the wheel from rest, 1; null if unknown
 * @property {string} kick the name of the kick that acts now, for people; empty if none does
 * @property {string} title the wheel's name, for people
 * @property {boolean} stale whether this is no longer up to date
 * @property {{forward: string, duty: string, turns: string}} labels 'forward', 'duty', 'turns/s'
 */

/**
 * Where the wheel is on its canvas.
 *
 * @param {HTMLCanvasElement} canvas the drawing's
 * @param {Object} theme see theme.js
 * @returns {{x: number, y: number, radius: number}} the axle and the wheel's radius, CSS pixels
 */
export function layout(canvas, theme) {
    const width = canvas.width / theme.scale;
    const height = canvas.height / theme.scale;
    const radius = Math.min(width, height) / (BEFORE + BEHIND);
    const aside = ((BEFORE - BEHIND) * radius) / 2;
    return { x: width / 2 + aside, y: height / 2 + aside, radius };
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
    const sheet = { ctx, colours, theme, line: theme.line, ...layout(canvas, theme) };
    // Where there is no room for all that can be said, it says the least.
    sheet.terse = theme.text < theme.legible;
    // Half the size of a mark, in radii; and what a kick's frame leaves free, CSS pixels.
    sheet.mark = Math.max(0.12, (0.36 * theme.text) / sheet.radius);
    sheet.edge = 3 * theme.line;
    sheet.quiet = { colour: colours.faint, halo: colours.paper };
    const pin = [Math.cos(state.phi_rad), Math.sin(state.phi_rad)];
    dot(sheet, [0, 0], 1.1, colours.ink, colours.ink);
    dot(sheet, [0, 0], 1.04, colours.rim, colours.ink);
    if (Number.isFinite(state.phi_rad)) {
        spokes(sheet, state, pin);
        for (const rod of [0, 1]) rodAndSpring(sheet, state, rod, pin);
        dot(sheet, pin, sheet.mark, colours.actual, colours.ink);
        if (state.kick) ghosts(sheet, [state.seen1, state.seen2], pin);
        force(sheet, state.torque, pin);
    }
    for (const rod of [0, 1]) scale(sheet, rod);
    directions(sheet, state);
    readout(sheet, state, width, height);
    if (state.kick) {
        ctx.strokeStyle = colours.kick;
        ctx.lineWidth = 2 * theme.line;
        ctx.strokeRect(theme.line, theme.line, width - 2 * theme.line, height - 2 * theme.line);
    }
}

/** A point on or beside a rail: the first one lies right of the wheel, the second one below it. */
function place(rod, along, aside) {
    return rod === 0 ? [RAIL + along, -aside] : [aside, along - RAIL];
}

/** A line through points, in radii from the axle; its width in CSS pixels. */
function line({ ctx, x, y, radius }, points, colour, width) {
    ctx.beginPath();
    for (const [right, up] of points) ctx.lineTo(x + right * radius, y - up * radius);
    ctx.strokeStyle = colour;
    ctx.lineWidth = width;
    ctx.stroke();
}

/** A disc with an edge; its place and size in radii. */
function dot({ ctx, x, y, radius, line: width }, [right, up], r, colour, edge) {
    ctx.beginPath();
    ctx.arc(x + right * radius, y - up * radius, r * radius, 0, 2 * Math.PI);
    ctx.fillStyle = colour;
    ctx.fill();
    ctx.strokeStyle = edge;
    ctx.lineWidth = 0.7 * width;
    ctx.stroke();
}

function scale(sheet, rod) {
    const { ctx, colours, theme, x, y, radius, line: width, quiet, terse } = sheet;
    line(sheet, [place(rod, -1, SCALE), place(rod, 1, SCALE)], colours.axis, 0.6 * width);
    const write = (text, [right, up], aside, below, how) =>
        theme.write(ctx, text, x + right * radius + aside, y - up * radius + below, how);
    for (const value of [-1, 0, 1]) {
        const end = place(rod, value, SCALE + 0.08);
        line(sheet, [place(rod, value, SCALE), end], colours.axis, 0.6 * width);
        if (terse) continue;
        const how = { ...quiet, size: 0.85, align: rod ? "left" : "center" };
        const [aside, below] = rod ? [0.4 * theme.text, 0] : [0, 0.75 * theme.text];
        write(theme.number(value), end, aside, below, how);
    }
    if (terse) return;
    const how = { ...quiet, symbol: true, align: rod ? "center" : "left" };
    const end = place(rod, 1.12, SCALE);
    const room = ctx.canvas.width / theme.scale - sheet.edge - theme.measure(ctx, "x₁", how);
    const aside = rod ? 0 : Math.min(0, room - x - end[0] * radius);
    write(rod ? "x₂" : "x₁", end, aside, -0.5 * rod * theme.text, how);
}

/** The spoke to the pin, and the neurons' memory beside it. */
function spokes(sheet, { phi_rad: phi, x1, x2 }, pin) {
    const { ctx, colours, x, y, radius, line: width } = sheet;
    for (const angle of [phi + (2 * Math.PI) / 3, phi - (2 * Math.PI) / 3]) {
        line(sheet, [[0, 0], [Math.cos(angle), Math.sin(angle)]], colours.axis, 0.6 * width);
    }
    line(sheet, [[0, 0], pin], colours.ink, 1.3 * width);
    const reach = Math.hypot(x1, x2);
    if (Number.isFinite(reach)) {
        const short = Math.min(1, 1.3 / reach);
        const [mx, my] = [x + x1 * short * radius, y - x2 * short * radius];
        line(sheet, [[0, 0], [x1 * short, x2 * short]], colours.memory, 1.3 * width);
        const half = sheet.mark * radius;
        ctx.beginPath();
        for (const [right, up] of [[1, 0], [0, 1], [-1, 0], [0, -1]]) {
            ctx.lineTo(mx + right * half, my + up * half);
        }
        ctx.fillStyle = colours.memory;
        ctx.fill();
    }
    dot(sheet, [0, 0], 0.08, colours.ink, colours.ink);
}

function rodAndSpring(sheet, state, rod, pin) {
    const { ctx, colours, x, y, radius, line: width } = sheet;
    const [actual, target] = [pin[rod], rod ? state.target2 : state.target1];
    const half = sheet.mark;
    line(sheet, [pin, place(rod, actual, 0)], colours.rod, 2.6 * width);
    line(sheet, [place(rod, actual, 0), place(rod, actual, SPRING)], colours.actual, 1.6 * width);
    if (Number.isFinite(target)) {
        const coil = [];
        for (let n = 0; n <= 2 * COILS; n++) {
            const aside = n % (2 * COILS) ? (n % 2 ? 0.1 : -0.1) : 0;
            const along = actual + ((target - actual) * n) / (2 * COILS);
            coil.push(place(rod, along, SPRING + aside));
        }
        line(sheet, coil, colours.ink, 0.7 * width);
        const [right, up] = place(rod, target, SPRING);
        const side = 2 * half * radius;
        ctx.fillStyle = colours.target;
        ctx.fillRect(x + (right - half) * radius, y - (up + half) * radius, side, side);
    }
    dot(sheet, place(rod, actual, 0), half, colours.actual, colours.ink);
}

/** What a quenched kick shows to the neurons, if it is not what is there. */
function ghosts(sheet, seen, pin) {
    const { ctx, colours, x, y, radius, theme } = sheet;
    if (!(Math.hypot(seen[0] - pin[0], seen[1] - pin[1]) > ROUNDING)) return;
    ctx.setLineDash([0.3 * theme.text, 0.22 * theme.text]);
    ctx.lineCap = "butt";
    line(sheet, [[0, 0], seen], colours.actual, theme.line);
    const r = (sheet.mark + 0.03) * radius;
    for (const [right, up] of [seen, place(0, seen[0], 0), place(1, seen[1], 0)]) {
        ctx.beginPath();
        ctx.arc(x + right * radius, y - up * radius, r, 0, 2 * Math.PI);
        ctx.lineWidth = 1.3 * theme.line;
        ctx.stroke();
    }
    ctx.setLineDash([]);
    ctx.lineCap = "round";
}

/** The tangential force: its direction, and |M| as its length. */
function force(sheet, torque, pin) {
    const { ctx, colours, theme, x, y, radius } = sheet;
    if (!(Math.abs(torque) > 0.01)) return;
    const tip = [pin[0] - pin[1] * torque, pin[1] + pin[0] * torque];
    const way = Math.sign(torque);
    const head = Math.min(0.8 * theme.text, Math.abs(torque) * radius);
    const neck = torque - (0.7 * way * head) / radius;
    const shaft = [pin, [pin[0] - pin[1] * neck, pin[1] + pin[0] * neck]];
    line(sheet, shaft, colours.force, 2.2 * theme.line);
    const [px, py] = [x + tip[0] * radius, y - tip[1] * radius];
    theme.arrowHead(ctx, px, py, -pin[1] * way, -pin[0] * way, head, colours.force);
}

/** Outside the rim: which way is forward, and how the wheel turns now. */
function directions(sheet, { omega_rad_s: omega, labels }) {
    const { ctx, colours, theme, x, y, radius, quiet, edge } = sheet;
    arc(sheet, 3.4, 4.0, colours.faint, 0.8 * theme.line);
    if (!sheet.terse) {
        const left = x - 0.65 * radius - theme.measure(ctx, labels?.forward ?? "", quiet);
        theme.write(ctx, labels?.forward ?? "", Math.max(edge, left), y + 1.42 * radius, quiet);
    }
    const half = Math.max(-LONGEST_ARC, Math.min(LONGEST_ARC, omega * ARC_S)) / 2;
    if (!(Math.abs(half) > 0.02)) return;
    arc(sheet, Math.PI / 2 - half, Math.PI / 2 + half, colours.ink, 1.8 * theme.line);
}

/** An arrow around the wheel between two angles. */
function arc({ ctx, theme, x, y, radius }, from, to, colour, width) {
    const [r, way] = [1.26 * radius, Math.sign(to - from)];
    const head = Math.min(0.7 * theme.text, Math.abs(to - from) * r);
    ctx.beginPath();
    ctx.arc(x, y, r, -from, -to + (0.8 * way * head) / r, way > 0);
    ctx.strokeStyle = colour;
    ctx.lineWidth = width;
    ctx.stroke();
    const [right, up] = [Math.cos(to), Math.sin(to)];
    theme.arrowHead(ctx, x + r * right, y - r * up, -up * way, -right * way, head, colour);
}

/** Numbers where the picture is empty, below on the right: as many as there is room for. */
function readout({ ctx, colours, theme, x, y, radius, terse }, state, width, height) {
    const text = terse ? theme.legible : theme.text;
    const size = text / theme.text;
    const how = { colour: state.kick ? colours.paper : colours.ink, bold: true, size };
    const title = state.kick || (state.title ?? "");
    const last = width - theme.measure(ctx, title, how) - 0.5 * text;
    const left = Math.min(x + Math.max(1.2 * radius, terse ? 0 : 0.8 * radius + 2 * text), last);
    const room = Math.min(width - left - 0.5 * text, 11 * text);
    const step = (terse ? 1.3 : 1.45) * text;
    let line = y + (terse ? 1.8 : 1.5) * radius;
    if (state.kick) {
        ctx.fillStyle = colours.kick;
        ctx.fillRect(left - 0.4 * text, line - 0.7 * text, room + 0.4 * text, 1.4 * text);
    }
    theme.write(ctx, title, left, line, how);
    const { omega_rad_s: omega, labels } = state;
    const turns = [theme.number(omega / 2 / Math.PI, 1, true), labels?.turns ?? ""];
    if (terse) {
        theme.write(ctx, turns[0], left, line + step, { colour: colours.ink, size });
        theme.write(ctx, turns[1], left, line + 2 * step, { colour: colours.faint, size });
        return;
    }
    const row = (name, value, unit, colour) => {
        line += step;
        if (line > height - 0.5 * text) return;
        theme.write(ctx, name, left, line, { colour, symbol: name.length === 1, bold: true });
        const numbers = left + Math.min(5.4 * text, room - 3.7 * text);
        theme.write(ctx, value, numbers, line, { colour, align: "right" });
        theme.write(ctx, unit, numbers + 0.4 * text, line, { colour: colours.faint });
    };
    const motor = state.torque !== undefined;
    if (motor) row("M", theme.number(state.torque, 2, true), "", colours.force);
    if (motor) gauge({ ctx, colours, theme }, left, (line += 0.85 * step), room, state);
    row("ω", theme.number(omega, 1, true), "rad/s", colours.ink);
    row("", ...turns, colours.ink);
    if (motor) row(labels?.duty ?? "", theme.number(state.duty_pct, 0, true), "%", colours.ink);
}

/** M between -1 and 1, with the band in which the wheel does not start. */
function gauge({ ctx, colours, theme }, left, y, room, { stall, torque }) {
    const half = 0.3 * theme.text;
    const x = (value) => left + ((value + 1) / 2) * room;
    ctx.fillStyle = colours.rim;
    ctx.fillRect(left, y - half, room, 2 * half);
    ctx.fillStyle = colours.axis;
    ctx.fillRect(x(0) - 0.5, y - 1.5 * half, 1, 3 * half);
    if (stall > 0) {
        ctx.fillRect(x(-stall), y - half, 1, 2 * half);
        ctx.fillRect(x(stall) - 1, y - half, 1, 2 * half);
        ctx.fillStyle = colours.band;
        ctx.fillRect(x(-stall) + 1, y - half, x(stall) - x(-stall) - 2, 2 * half);
    }
    if (!Number.isFinite(torque)) return;
    ctx.fillStyle = colours.force;
    ctx.fillRect(x(Math.min(0, torque)), y - half / 2, (Math.abs(torque) * room) / 2, half);
    ctx.fillRect(x(torque) - theme.line, y - 1.5 * half, 2 * theme.line, 3 * half);
}
