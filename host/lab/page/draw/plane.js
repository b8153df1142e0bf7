/**
 * A phase plane: where the robot's state has been, the older the fainter, and where it is now.
 *
 * An axis may be wrapped, as an angle is: a trace leaves at one edge and enters at the other. What
 * jumps, such as the potentials in a membrane kick, is joined by dots.
 */

// How visible the oldest part of a trace is. What is older than this part of it is one pixel wide,
// which Chromium paints ten times faster than wider lines.
const FAINTEST = 0.15;
const OLD = 0.5;
// How many records have one shade and are drawn in one go: Chromium paints long paths slowly.
const PIECE = 16;

/**
 * @typedef {Object} Axis
 * @property {string} symbol the quantity, such as 'φ' or 'ω/2π'
 * @property {string} unit such as 'rad' or '1/s'; empty if it has none
 * @property {number} minimum of the axis, in its unit
 * @property {number} maximum of the axis, in its unit
 * @property {boolean} pi whether its numbers are multiples of pi
 * @property {boolean} wrap whether its ends are the same place
 */

/**
 * @typedef {Object} Trace
 * @property {Float64Array|Float32Array} x ring, in the unit of the x axis times `scale_x`
 * @property {Float64Array|Float32Array} y ring, in the unit of the y axis times `scale_y`
 * @property {number} scale_x what x is multiplied by, 1 if missing
 * @property {number} scale_y what y is multiplied by, 1 if missing
 * @property {?Uint8Array} jumped ring; not 0 where a kick made the state jump in this record
 * @property {string} colour its name in the theme
 * @property {boolean} dashed whether its line is dashed
 * @property {string} name the wheel's, for people, beside its present point
 * @property {?{x: number, y: number}} ghost where a quenched kick lets the state seem to be, in the
 *     axes' units; null without one
 */

/**
 * @typedef {Object} PlaneState
 * @property {Axis} x the horizontal axis
 * @property {Axis} y the vertical axis
 * @property {?{sheet: CanvasImageSource, high: number}} ground a picture under the traces, over the
 *     whole horizontal axis, from -high to high of the vertical one
 * @property {Trace[]} traces rings of equal length; NaN interrupts a trace
 * @property {number} start index of the oldest record in the rings
 * @property {number} count how many records to draw
 * @property {boolean} equal whether a unit is as long on both axes
 * @property {boolean} even whether old parts of a trace are as visible as new ones
 * @property {string} title for people
 * @property {string} note for people, such as 'a slice of four dimensions'
 * @property {boolean} stale whether this is no longer up to date
 */

/**
 * Draw a phase plane.
 *
 * @param {HTMLCanvasElement} canvas its width and height are device pixels
 * @param {PlaneState} state what is not known may be missing
 * @param {Object} theme see theme.js
 */
export function draw(canvas, state, theme) {
    const { ctx, width, height, colours } = theme.start(canvas, state.stale);
    const pen = { ctx, colours, theme };
    const [x, y] = [range(state.x), range(state.y)];
    const box = layout(state, theme, width, height);
    const { sheet, high } = state.ground ?? {};
    if (sheet) {
        const up = (high / y.long) * box.height;
        ctx.drawImage(sheet, box.left, box.top + box.height / 2 - up, box.width, 2 * up);
    }
    axes(pen, state, box, x, y);
    ctx.save();
    ctx.beginPath();
    ctx.rect(box.left, box.top, box.width, box.height);
    ctx.clip();
    for (const trace of state.traces ?? []) course(pen, state, trace, box, x, y);
    ctx.restore();
    const names = [];
    for (const trace of state.traces ?? []) present(pen, state, trace, box, x, y, names);
}

function range(axis) {
    const [low, high] = [axis?.minimum ?? -1, axis?.maximum ?? 1];
    return { low, high, long: high - low, wrap: Boolean(axis?.wrap), pi: Boolean(axis?.pi) };
}

/**
 * Where the axes' box lies.
 *
 * @param {PlaneState} state
 * @param {Object} theme see theme.js
 * @param {number} width of the drawing, CSS pixels
 * @param {number} height of the drawing, CSS pixels
 * @returns {{left: number, top: number, width: number, height: number}} CSS pixels
 */
export function layout(state, theme, width, height) {
    const [x, y] = [range(state.x), range(state.y)];
    const text = theme.text;
    const box = { left: 3.4 * text, top: 2.2 * text };
    box.width = width - box.left - text;
    box.height = height - box.top - 2.9 * text;
    if (state.equal) {
        const unit = Math.min(box.width / x.long, box.height / y.long);
        box.left += (box.width - unit * x.long) / 2;
        box.top += (box.height - unit * y.long) / 2;
        box.width = unit * x.long;
        box.height = unit * y.long;
    }
    // Clipping at whole pixels is painted much faster.
    for (const side of Object.keys(box)) box[side] = Math.round(box[side]);
    return box;
}

function axes({ ctx, colours, theme }, state, box, x, y) {
    const text = theme.text;
    const bottom = box.top + box.height;
    const right = box.left + box.width;
    const how = { colour: colours.faint, size: 0.85, align: "center" };
    for (const value of theme.ticks(x.low, x.high, box.width / (4.5 * text), x.pi ? Math.PI : 1)) {
        const at = box.left + ((value - x.low) / x.long) * box.width;
        ctx.fillStyle = colours.grid;
        ctx.fillRect(at - 0.5, box.top, 1, box.height);
        theme.write(ctx, label(theme, value, x.pi), at, bottom + 0.8 * text, how);
    }
    how.align = "right";
    const levels = theme.ticks(y.low, y.high, box.height / (2 * text), y.pi ? Math.PI : 1);
    // A low one has room for its ends at least.
    for (const value of levels.length > 1 ? levels : [y.low, ...levels, y.high]) {
        const at = bottom - ((value - y.low) / y.long) * box.height;
        ctx.fillStyle = colours.grid;
        ctx.fillRect(box.left, at - 0.5, box.width, 1);
        theme.write(ctx, label(theme, value, y.pi), box.left - 0.4 * text, at, how);
    }
    ctx.strokeStyle = colours.axis;
    ctx.lineWidth = 0.6 * theme.line;
    ctx.strokeRect(box.left, box.top, box.width, box.height);
    quantity({ ctx, colours, theme }, state.x, right, bottom + 2 * text, "right");
    quantity({ ctx, colours, theme }, state.y, 0.5 * text, box.top - 1.1 * text, "left");
    const note = { colour: colours.faint, size: 0.85, align: "right" };
    theme.write(ctx, state.note ?? "", right, box.top - 1.1 * text, note);
    const title = { colour: colours.ink, bold: true };
    theme.write(ctx, state.title ?? "", box.left, bottom + 2 * text, title);
}

/** The name of a quantity and its unit, from x on or up to x. */
function quantity({ ctx, colours, theme }, axis, x, y, align) {
    const { symbol = "", unit = "" } = axis ?? {};
    const name = { colour: colours.ink, align, symbol: true, bold: true };
    const measure = { colour: colours.faint, align, size: 0.85 };
    const gap = 0.4 * theme.text;
    if (align === "left") {
        x += theme.run(ctx, symbol, x, y, name) + gap;
        theme.write(ctx, unit, x, y, measure);
    } else {
        if (unit) x -= theme.run(ctx, unit, x, y, measure) + gap;
        theme.write(ctx, symbol, x, y, name);
    }
}

function label(theme, value, pi) {
    if (!pi) return theme.number(value, Math.abs(value % 1) > 1e-9 ? 1 : 0);
    const quarters = Math.round((value / Math.PI) * 4);
    if (!quarters) return "0";
    const sign = quarters < 0 ? "−" : "";
    const size = Math.abs(quarters);
    const below = size % 4 ? (size % 2 ? 4 : 2) : 1;
    const above = (size * below) / 4;
    return sign + (above === 1 ? "" : above) + "π" + (below === 1 ? "" : "/" + below);
}

/** A value within an axis; a wrapped one comes back at the other end. */
function within(value, axis) {
    if (!axis.wrap) return value;
    const turns = (value - axis.low) / axis.long;
    return axis.low + (turns - Math.floor(turns)) * axis.long;
}

/** How many times an axis is left between two places, -1, 0 or 1: the shorter way counts. */
function crossing(from, to, axis) {
    if (!axis.wrap || Math.abs(to - from) <= axis.long / 2) return 0;
    return to < from ? 1 : -1;
}

function course(pen, state, trace, box, x, y) {
    const { ctx, colours, theme } = pen;
    const { start = 0, count = 0 } = state;
    if (!trace.x || !trace.y) return;
    const bottom = box.top + box.height;
    const horizontal = (value) => box.left + ((value - x.low) / x.long) * box.width;
    const vertical = (value) => bottom - ((value - y.low) / y.long) * box.height;
    const jumps = [];
    let [px, py, down] = [NaN, NaN, false];
    ctx.strokeStyle = colours[trace.colour] ?? colours.ink;
    ctx.lineCap = "butt";
    if (trace.dashed) ctx.setLineDash(theme.dash);
    ctx.beginPath();
    for (let n = 0; n < count; n++) {
        const index = (start + n) % trace.x.length;
        const vx = within(trace.x[index] * (trace.scale_x ?? 1), x);
        const vy = within(trace.y[index] * (trace.scale_y ?? 1), y);
        if (trace.jumped?.[index]) {
            jumps.push([px, py, vx, vy]);
            down = false;
        } else if (Number.isFinite(px + py + vx + vy)) {
            const [cx, cy] = [crossing(px, vx, x) * x.long, crossing(py, vy, y) * y.long];
            if (!down) ctx.moveTo(horizontal(px), vertical(py));
            ctx.lineTo(horizontal(vx + cx), vertical(vy + cy));
            if (cx || cy) {
                ctx.moveTo(horizontal(px - cx), vertical(py - cy));
                ctx.lineTo(horizontal(vx), vertical(vy));
            }
            down = true;
        } else down = false;
        [px, py] = [vx, vy];
        // Pieces end at fixed records, so that dashes stay where they are while time goes on.
        if (index % PIECE === 0 || n === count - 1) {
            const age = state.even ? 0 : 1 - (n + 1) / count;
            ctx.globalAlpha = FAINTEST + (1 - FAINTEST) * (1 - age) ** 2;
            ctx.lineWidth = age > OLD ? 1 / theme.scale : theme.line;
            ctx.stroke();
            ctx.beginPath();
            down = false;
        }
    }
    ctx.globalAlpha = 1;
    ctx.lineCap = "round";
    ctx.strokeStyle = colours.kick;
    ctx.lineWidth = theme.line;
    ctx.setLineDash([0.1, 2.5 * theme.line]);
    for (const [fx, fy, tx, ty] of jumps) {
        ctx.moveTo(horizontal(fx), vertical(fy));
        ctx.lineTo(horizontal(tx), vertical(ty));
    }
    ctx.stroke();
    ctx.setLineDash([]);
}

/** Where the state is now, and where a quenched kick lets it seem to be. */
function present({ ctx, colours, theme }, state, trace, box, x, y, names) {
    const { start = 0, count = 0 } = state;
    if (!trace.x || !trace.y || !(count > 0)) return;
    const text = theme.text;
    const index = (start + count - 1) % trace.x.length;
    const vx = within(trace.x[index] * (trace.scale_x ?? 1), x);
    const vy = within(trace.y[index] * (trace.scale_y ?? 1), y);
    const at = (u, v) => [
        box.left + ((u - x.low) / x.long) * box.width,
        box.top + box.height - ((v - y.low) / y.long) * box.height,
    ];
    if (!Number.isFinite(vx + vy)) return;
    ctx.beginPath();
    ctx.arc(...at(vx, vy), 0.42 * text, 0, 2 * Math.PI);
    ctx.fillStyle = colours.actual;
    ctx.fill();
    ctx.strokeStyle = colours[trace.colour] ?? colours.ink;
    ctx.lineWidth = theme.line;
    ctx.stroke();
    const [px, py] = at(vx, vy);
    const far = px > box.left + box.width - 4 * text;
    const how = { colour: ctx.strokeStyle, align: far ? "right" : "left", halo: colours.paper };
    // Where two points are near each other, the second one's name moves towards the middle.
    const near = names.find(([u, v]) => Math.abs(u - px) < 6 * text && Math.abs(v - py) < text);
    const level = near ? near[1] + (near[1] > box.top + box.height / 2 ? -1.2 : 1.2) * text : py;
    names.push([px, level]);
    const aside = px + (far ? -0.7 : 0.7) * text;
    theme.write(ctx, trace.name ?? "", aside, level, { ...how, size: 0.9 });
    if (!trace.ghost) return;
    const [gx, gy] = [within(trace.ghost.x, x), within(trace.ghost.y, y)];
    if (!Number.isFinite(gx + gy)) return;
    ctx.beginPath();
    ctx.arc(...at(gx, gy), 0.5 * text, 0, 2 * Math.PI);
    ctx.setLineDash([0.3 * text, 0.22 * text]);
    ctx.lineCap = "butt";
    ctx.strokeStyle = colours.actual;
    ctx.lineWidth = 1.3 * theme.line;
    ctx.stroke();
    ctx.setLineDash([]);
    ctx.lineCap = "round";
}
