/**
 * What the wheels did at each k that a person has held: one plane for their speed, one for |M|.
 *
 * Where k was raised, marks point up, where it was lowered, down; the first one is a circle. Those
 * of the left wheel are filled, those of the right one are larger. Lines join what followed each
 * other.
 */

const SIDES = ["left", "right"];
// What the marks in the key show: a name, whether k was raised, and whether they are filled.
const KEY = [
    ["up", true, true],
    ["down", false, true],
    ["left", null, true],
    ["right", null, false],
];

/**
 * @typedef {Object} KTraceState
 * @property {import("../k_trace.js").Hold[]} holds the oldest first
 * @property {{up: string, down: string, left: string, right: string}} labels for people
 * @property {boolean} stale whether this is no longer up to date
 */

/**
 * Draw both planes.
 *
 * @param {HTMLCanvasElement} canvas its width and height are device pixels
 * @param {KTraceState} state what is not known may be missing
 * @param {Object} theme see theme.js
 */
export function draw(canvas, state, theme) {
    const { ctx, width, height, colours } = theme.start(canvas, state.stale);
    const text = theme.text;
    const holds = (state.holds ?? []).filter(({ means }) => means.left && means.right);
    const ks = holds.map(({ k }) => k);
    const [low, high] = [Math.floor(Math.min(0, ...ks)), Math.ceil(Math.max(2, ...ks))];
    const fastest = Math.max(5, ...holds.flatMap(({ means }) => speeds(means)));
    const left = 3.4 * text;
    const pen = { ctx, colours, theme, left, wide: width - left - text, low, high };
    const tall = (height - 8 * text) / 2;
    const planes = [
        { name: "omega_rad_s", symbol: "|ω|", unit: "rad/s", most: 5 * Math.ceil(fastest / 5) },
        { name: "torque", symbol: "|M|", unit: "", most: 1 },
    ];
    planes.forEach((plane, n) => {
        const top = (2 + n * 2.4) * text + n * tall;
        axes(pen, { ...plane, top, tall });
        for (const side of SIDES) course(pen, { ...plane, top, tall }, holds, side);
    });
    const bottom = height - 3.6 * text;
    for (const value of theme.ticks(low, high, pen.wide / (4 * text))) {
        const how = { colour: colours.faint, size: 0.85, align: "center" };
        const words = theme.number(value, value % 1 ? 1 : 0);
        theme.write(ctx, words, across(pen, value), bottom + text, how);
    }
    const how = { colour: colours.ink, align: "right", symbol: true, bold: true };
    theme.write(ctx, "k", left + pen.wide, bottom + 2.6 * text, how);
    key(pen, state.labels ?? {}, bottom + 2.6 * text);
}

function speeds(means) {
    return SIDES.map((side) => means[side].omega_rad_s);
}

function across({ left, wide, low, high }, k) {
    return left + ((k - low) / (high - low)) * wide;
}

function up({ top, tall, most }, value) {
    return top + tall - (Math.min(value, most) / most) * tall;
}

function axes({ ctx, colours, theme, left, wide }, plane) {
    const { top, tall, most, symbol, unit } = plane;
    const text = theme.text;
    const how = { colour: colours.faint, size: 0.85, align: "right" };
    for (const value of theme.ticks(0, most, tall / (2 * text))) {
        const y = up(plane, value);
        theme.rule(ctx, left, left + wide, y, colours.grid, false);
        theme.write(ctx, theme.number(value, value % 1 ? 1 : 0), left - 0.4 * text, y, how);
    }
    ctx.strokeStyle = colours.axis;
    ctx.lineWidth = 0.6 * theme.line;
    ctx.strokeRect(left, top, wide, tall);
    const name = { colour: colours.ink, symbol: true, bold: true };
    const long = theme.run(ctx, symbol, 0.3 * text, top - text, name);
    theme.write(ctx, unit, long + 0.7 * text, top - text, { colour: colours.faint, size: 0.85 });
}

function course(pen, plane, holds, side) {
    const { ctx, colours, theme } = pen;
    const points = holds.map((hold) => ({
        ...hold,
        x: across(pen, hold.k),
        y: up(plane, hold.means[side][plane.name]),
    }));
    points.slice(1).forEach((point, n) => {
        const before = points[n];
        ctx.strokeStyle = way(point, colours);
        ctx.lineWidth = theme.line;
        ctx.setLineDash(side === "right" ? theme.dash : []);
        ctx.beginPath();
        ctx.moveTo(before.x, before.y);
        ctx.lineTo(point.x, point.y);
        ctx.stroke();
    });
    ctx.setLineDash([]);
    for (const point of points) mark(pen, point, side === "left");
}

function way({ up: raised }, colours) {
    return raised === null ? colours.ink : raised ? colours.raised : colours.lowered;
}

function mark({ ctx, colours, theme }, point, filled) {
    // So that both wheels are seen where they do the same.
    const size = (filled ? 0.28 : 0.48) * theme.text;
    const { x, y, up: raised } = point;
    ctx.beginPath();
    if (raised === null) ctx.arc(x, y, 0.8 * size, 0, 2 * Math.PI);
    else {
        const tip = raised ? -size : size;
        ctx.moveTo(x, y + tip);
        ctx.lineTo(x + size, y - 0.7 * tip);
        ctx.lineTo(x - size, y - 0.7 * tip);
        ctx.closePath();
    }
    const colour = way(point, colours);
    ctx.fillStyle = colour;
    if (filled) ctx.fill();
    ctx.strokeStyle = colour;
    ctx.lineWidth = 0.8 * theme.line;
    ctx.stroke();
}

/** What the marks mean, from the left. */
function key(pen, labels, y) {
    const { ctx, colours, theme } = pen;
    const text = theme.text;
    let x = text;
    for (const [name, raised, filled] of KEY) {
        mark(pen, { x, y, up: raised }, filled);
        const how = { colour: colours.faint, size: 0.85 };
        x += 0.7 * text;
        x += theme.run(ctx, labels[name] ?? "", x, y, how) + 1.1 * text;
    }
}
