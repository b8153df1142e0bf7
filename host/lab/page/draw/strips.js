/**
 * Strips: how the robot's channels went in the last seconds, newest at the right edge.
 *
 * From above: membrane potentials of both wheels, torques M with the stall band, angular
 * velocities, and delta t with the control period. The left wheel's lines are solid, the right
 * wheel's dashed. Kicks are bands with their names. Where many records share a pixel column, their
 * extremes are drawn, so that a spike of one tick stays visible. Rows without room are left out.
 */

// A line does not bridge a longer gap, s: there, records are lost.
const GAP_S = 0.25;
// With more records than this for each pixel, a line shows only the extremes of columns so many
// pixels wide: rectangles cost more time than records.
const [DENSE, COLUMN] = [1.5, 2];
// How many records are drawn in one go: Chromium paints long paths slowly.
const PIECE = 32;
const LEAST = 1.2; // the height of a strip of weight 1 at least, in heights of the text
// What a row may reach to, by its quantity: 1 and rad/s.
const X = [1, 2, 5, 10, 20];
const OMEGA = [5, 10, 20, 50, 100];
const ROWS = [
    { symbol: "x", weight: 1.5, limits: X, lines: wheels(["x1", "x2"], ["x₁", "x₂"]) },
    { symbol: "M", weight: 1, limits: [1], lines: wheels(["torque"]) },
    { symbol: "ω", unit: "rad/s", weight: 1, limits: OMEGA, lines: wheels(["omega_rad_s"]) },
    {
        symbol: "Δt",
        unit: "ms",
        weight: 0.7,
        factor: 1000,
        limits: [20, 50, 100, 200, 500, 1000],
        positive: true,
        lines: [{ column: "dt_s", colour: "left" }],
    },
];

/** The lines of both wheels' channels; names are for people. */
function wheels(channels, names = []) {
    const line = (side, channel, n) => ({
        column: side + "_" + channel,
        colour: side + (names.length ? n + 1 : ""),
        name: names[n],
        right: side === "right",
    });
    return ["left", "right"].flatMap((side) => channels.map((name, n) => line(side, name, n)));
}

/**
 * @typedef {Object} Kick
 * @property {number} begin_s when it begins, s of the robot's clock
 * @property {number} end_s when it ends, s of the robot's clock; null while it acts
 * @property {string} name for people
 */

/**
 * @typedef {Object} StripsState
 * @property {Object<string, Float64Array|Float32Array>} columns rings of equal length by name of
 *     the channel: t_s (ascending), dt_s, and with `left_` and `right_` in front x1, x2, torque,
 *     omega_rad_s. Units as the robot's table says: s, 1, rad/s. One that is missing is not drawn.
 * @property {number} start index of the oldest record in the rings
 * @property {number} count how many records the rings hold
 * @property {number} now_s the time at the right edge, s of the robot's clock
 * @property {number} seconds how much the strips show, s
 * @property {?number} tick_s the control period, s
 * @property {?number} stall the least |M| that moves a wheel from rest, 1; null if unknown
 * @property {Kick[]} kicks oldest first
 * @property {boolean} stale whether this is no longer up to date
 * @property {{left: string, right: string, stall: string, period: string}} labels words: 'left',
 *     'right', 'stalls', 'control period'
 */

/**
 * Draw the strips.
 *
 * @param {HTMLCanvasElement} canvas its width and height are device pixels
 * @param {StripsState} state what is not known may be missing
 * @param {Object} theme see theme.js
 */
export function draw(canvas, state, theme) {
    const { ctx, width, height, colours } = theme.start(canvas, state.stale);
    const text = theme.text;
    const seconds = state.seconds > 0 ? state.seconds : 10;
    const now = Number.isFinite(state.now_s) ? state.now_s : 0;
    const left = 3 * text;
    const right = width - 0.6 * text;
    const top = state.kicks?.length ? 1.5 * text : 0.3 * text;
    const bottom = height - 1.7 * text;
    const view = { ctx, colours, theme, left, right, now, pixels: (right - left) / seconds };
    const shown = recent(state, now - seconds);
    const header = 1.5 * text;
    const { rows, share } = fitting(bottom - top, header, LEAST * text);
    let y = top;
    times(view, state, seconds, top, bottom);
    for (const row of rows) {
        const box = { top: y + header, bottom: y + header + share * row.weight };
        legend(view, row, state, y + 0.42 * header);
        strip(view, row, state, shown, box);
        y = box.bottom;
    }
}

/** The rows that have room, and how high one of weight 1 is then. */
function fitting(room, header, least, rows = ROWS) {
    const weights = rows.reduce((sum, row) => sum + row.weight, 0);
    const share = (room - rows.length * header) / weights;
    if (share >= least || rows.length === 1) return { rows, share };
    return fitting(room, header, least, rows.slice(0, -1));
}

/** The part of the rings from a time on, as the first record's number and one behind the last. */
function recent({ columns, start = 0, count = 0 }, from_s) {
    const t = columns?.t_s;
    if (!t || !(count > 0)) return { first: 0, last: 0 };
    let low = 0;
    let high = count;
    while (low < high) {
        const middle = (low + high) >> 1;
        if (t[(start + middle) % t.length] < from_s) low = middle + 1;
        else high = middle;
    }
    return { first: Math.max(0, low - 1), last: count };
}

/** Lines of time, and kicks as bands with their names. */
function times({ ctx, colours, theme, left, right, now, pixels }, state, seconds, top, bottom) {
    const text = theme.text;
    for (const ago of theme.ticks(0, seconds, Math.floor((right - left) / (4.5 * text)))) {
        const x = right - ago * pixels;
        ctx.fillStyle = colours.grid;
        ctx.fillRect(x - 0.5, top, 1, bottom - top);
        const how = { colour: colours.faint, size: 0.9, align: ago ? "center" : "right" };
        theme.write(ctx, theme.number(-ago, ago % 1 ? 1 : 0) + " s", x, bottom + text, how);
    }
    let free = right;
    for (let n = (state.kicks ?? []).length - 1; n >= 0; n--) {
        const kick = state.kicks[n];
        const end = Math.min(right, right - (now - (kick.end_s ?? now)) * pixels);
        const begin = Math.max(left, right - (now - kick.begin_s) * pixels);
        if (!(end >= left && begin <= right)) continue;
        const wide = Math.max(2, end - begin);
        ctx.fillStyle = colours.kick;
        ctx.globalAlpha = 0.22;
        ctx.fillRect(begin, top, wide, bottom - top);
        ctx.globalAlpha = 1;
        ctx.fillRect(begin - 0.5, top - 0.2 * text, 1, bottom - top + 0.2 * text);
        const how = { colour: colours.kick, bold: true };
        const long = theme.measure(ctx, kick.name ?? "", how);
        const x = Math.min(begin, right - long);
        if (x + long > free) continue;
        theme.write(ctx, kick.name ?? "", x, top - 0.8 * text, how);
        free = x - text;
    }
}

/** What a strip shows, above it. */
function legend({ ctx, colours, theme, left, right }, row, state, y) {
    const words = state.labels ?? {};
    const text = theme.text;
    const strong = { colour: colours.ink, symbol: true, bold: true };
    const behind = left + theme.run(ctx, row.symbol, left, y, strong) + 0.4 * text;
    theme.write(ctx, row.unit ?? "", behind, y, { colour: colours.faint, size: 0.9 });
    let x = right;
    for (let n = row.lines.length - 1; n >= 0 && row.lines.length > 1; n--) {
        const line = row.lines[n];
        const last = row.lines[n + 1]?.right !== line.right;
        const side = line.right ? words.right : words.left;
        const how = { colour: colours.faint, size: 0.9, align: "right" };
        if (last && side) x -= theme.run(ctx, side, x, y, how) + 0.4 * text;
        if (line.name) x -= theme.run(ctx, line.name, x, y, how) + 0.3 * text;
        theme.rule(ctx, x - 1.6 * text, x, y, colours[line.colour], line.right);
        x -= 1.6 * text + 0.8 * text;
    }
}

function strip(view, row, state, shown, box) {
    const { ctx, colours, theme, left, right } = view;
    const high = limit(row, state, shown);
    const low = row.positive ? 0 : -high;
    const margin = 0.06 * (high - low);
    const unit = (box.bottom - box.top) / (high - low + 2 * margin);
    const zero = box.bottom - (margin - low) * unit;
    const roomy = box.bottom - box.top > 3 * theme.text;
    const note = (words, y, colour) => {
        const how = { colour, size: 0.85, align: "right", halo: colours.paper };
        if (roomy && words) theme.write(ctx, words, right - 3, y - 0.65 * theme.text, how);
    };
    if (row.symbol === "M" && state.stall > 0) {
        ctx.fillStyle = colours.band;
        ctx.fillRect(left, zero - state.stall * unit, right - left, 2 * state.stall * unit);
        note(state.labels?.stall, zero - state.stall * unit, colours.faint);
    }
    const most = Math.max(2, Math.floor((box.bottom - box.top) / (1.8 * theme.text)));
    let free = Infinity;
    for (const value of theme.ticks(low, high, most)) {
        const y = zero - value * unit;
        ctx.fillStyle = value ? colours.grid : colours.axis;
        ctx.fillRect(left, y - 0.5, right - left, 1);
        const how = { colour: colours.faint, size: 0.85, align: "right" };
        if (y > free) continue;
        theme.write(ctx, theme.number(value, value % 1 ? 1 : 0), left - 0.4 * theme.text, y, how);
        free = y - theme.text;
    }
    if (row.positive && state.tick_s > 0) {
        const y = zero - state.tick_s * (row.factor ?? 1) * unit;
        theme.rule(ctx, left, right, y, colours.target, true);
        note(state.labels?.period, y, colours.target);
    }
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, box.top, right - left, box.bottom - box.top);
    ctx.clip();
    const many = shown.last - shown.first > DENSE * (right - left) * theme.scale;
    const channel = many ? bars : polyline;
    for (const line of row.lines) {
        if (!state.columns?.[line.column]) continue;
        ctx.strokeStyle = ctx.fillStyle = colours[line.colour];
        channel(view, state, shown, line, zero, unit * (row.factor ?? 1));
    }
    ctx.restore();
}

/** The least of a row's limits that holds all of its values. */
function limit(row, state, { first, last }) {
    let most = 0;
    for (const { column } of row.lines) {
        const data = state.columns?.[column];
        if (!data) continue;
        let index = (state.start + first) % data.length;
        for (let n = first; n < last; n++) {
            const size = Math.abs(data[index]);
            if (size > most && size < Infinity) most = size;
            if (++index === data.length) index = 0;
        }
    }
    const fits = row.limits.find((value) => most * (row.factor ?? 1) <= 1.05 * value);
    return fits ?? row.limits[row.limits.length - 1];
}

/** A line through a channel's values, while they are few. */
function polyline({ ctx, theme, right, now, pixels }, state, shown, line, zero, unit) {
    const { t_s: t, [line.column]: data } = state.columns;
    let before = NaN;
    ctx.lineWidth = theme.line;
    ctx.lineCap = "butt";
    ctx.setLineDash(line.right ? theme.dash : []);
    ctx.beginPath();
    // Pieces begin at fixed records, so that dashes stay where they are while time goes on.
    const ahead = (state.start + shown.first) % PIECE;
    for (let n = Math.max(0, shown.first - ahead); n < shown.last; n++) {
        const index = (state.start + n) % data.length;
        const [x, y] = [right - (now - t[index]) * pixels, zero - data[index] * unit];
        // NaN in either is a gap.
        const joined = t[index] - before <= GAP_S && y - y === 0;
        if (joined) ctx.lineTo(x, y);
        if (!joined || index % PIECE === 0) {
            ctx.stroke();
            ctx.beginPath();
            ctx.moveTo(x, y);
        }
        before = y - y === 0 ? t[index] : NaN;
    }
    ctx.stroke();
}

/** A bar from the least to the greatest value in each column of pixels, where values are many. */
function bars({ ctx, theme, right, now, pixels }, state, shown, line, zero, unit) {
    const { t_s: t, [line.column]: data } = state.columns;
    const { scale } = theme;
    const rate = (pixels * scale) / COLUMN;
    const wide = Math.max(1, COLUMN / scale);
    // Columns are fixed in time, and stand on whole pixels: nothing flickers while time goes on.
    const shift = Math.round((right - now * pixels) * scale);
    let [column, least, greatest, last, before] = [NaN, 0, 0, NaN, NaN];
    const flush = () => {
        if (Number.isNaN(column)) return;
        // In place of dashes, which would hide a spike.
        if (line.right) ctx.globalAlpha = (column / scale) % 10 >= 6 ? 0.4 : 1;
        const high = (greatest - least) * unit + theme.line;
        ctx.fillRect((shift + column) / scale, zero - greatest * unit - theme.line / 2, wide, high);
    };
    let index = (state.start + shown.first) % data.length;
    for (let n = shown.first; n < shown.last; n++) {
        const [time, value] = [t[index], data[index]];
        if (++index === data.length) index = 0;
        const here = COLUMN * Math.floor(time * rate);
        if (here !== column || value - value !== 0) {
            flush();
            column = value - value === 0 ? here : NaN;
            least = greatest = value;
            // What joins two columns belongs to the second one. A NaN in either is a gap.
            if (time - before <= GAP_S) {
                if (last < least) least = last;
                else if (last > greatest) greatest = last;
            }
        } else if (value < least) least = value;
        else if (value > greatest) greatest = value;
        [last, before] = [value, time];
    }
    flush();
    ctx.globalAlpha = 1;
}
