/**
 * What the simulation expects of a kick, and what came of it: for each wheel a bar of shares, with
 * marks at what the person expects and at what the wheel did.
 */

const KINDS = ["reverses", "continues", "stops"];

/**
 * @typedef {Object} WheelScore
 * @property {string} name the wheel's, for people
 * @property {?{reverses: number, continues: number, stops: number}} shares how many of the
 *     simulated robots do so
 * @property {?string} outcome one of `reverses`, `continues`, `stops`; null while it is open
 */

/**
 * @typedef {Object} ScoreState
 * @property {WheelScore[]} wheels from above
 * @property {number} of how many robots were simulated
 * @property {?string} guess what the person expects, as an outcome; null without a guess
 * @property {boolean} stale whether this is no longer up to date
 * @property {{reverses: string, continues: string, stops: string, outcome: string, guess: string}}
 *     labels words: 'reverses', 'continues', 'stops', 'what it did', 'your guess'
 */

/**
 * Draw predictions beside their outcomes.
 *
 * @param {HTMLCanvasElement} canvas its width and height are device pixels
 * @param {ScoreState} state what is not known may be missing
 * @param {Object} theme see theme.js
 */
export function draw(canvas, state, theme) {
    const { ctx, width, height, colours } = theme.start(canvas, state.stale);
    const wheels = state.wheels ?? [];
    const text = theme.text;
    const left = 4.2 * text;
    const pen = { ctx, colours, theme, left, wide: width - left - text };
    legend(pen, state, text);
    const top = 2.2 * text;
    const step = (height - top) / Math.max(1, wheels.length);
    wheels.forEach((wheel, n) => {
        const y = top + (n + 0.5) * step;
        theme.write(ctx, wheel.name ?? "", 0.5 * text, y, { colour: colours.ink, bold: true });
        bar(pen, state, wheel, y, Math.min(1.8 * text, 0.35 * step));
    });
}

function legend({ ctx, colours, theme }, state, y) {
    const text = theme.text;
    let x = 0.5 * text;
    for (const kind of KINDS) {
        fill(ctx, colours, kind, x, y - 0.4 * text, 0.8 * text, 0.8 * text, theme.line);
        x += 1.1 * text;
        x += theme.run(ctx, state.labels?.[kind] ?? "", x, y, { colour: colours.ink }) + text;
    }
}

/** Each kind has its pattern as well as its colour. */
function fill(ctx, colours, kind, x, y, wide, high, line) {
    ctx.fillStyle = ctx.strokeStyle = colours[kind];
    ctx.lineWidth = line / 2;
    if (kind === "reverses") ctx.fillRect(x, y, wide, high);
    else if (kind === "continues") {
        ctx.save();
        ctx.beginPath();
        ctx.rect(x, y, wide, high);
        ctx.clip();
        ctx.beginPath();
        for (let at = x - high; at < x + wide; at += 4 * line) {
            ctx.moveTo(at, y + high);
            ctx.lineTo(at + high, y);
        }
        ctx.lineWidth = line;
        ctx.stroke();
        ctx.restore();
    }
    ctx.strokeRect(x, y, wide, high);
}

function bar(pen, state, wheel, y, high) {
    const { ctx, colours, theme, left, wide } = pen;
    const text = theme.text;
    const half = high / 2;
    ctx.strokeStyle = colours.axis;
    ctx.lineWidth = theme.line / 2;
    ctx.strokeRect(left, y - half, wide, high);
    if (!wheel.shares || !(state.of > 0)) return;
    let x = left;
    for (const kind of KINDS) {
        const share = ((wheel.shares[kind] || 0) / state.of) * wide;
        if (share > 0) {
            fill(ctx, colours, kind, x, y - half, share, high, theme.line);
            const words = String(wheel.shares[kind]);
            const how = { colour: colours.ink, align: "center", bold: true, halo: colours.paper };
            if (share > 1.2 * text) theme.write(ctx, words, x + share / 2, y, how);
        }
        const middle = x + share / 2;
        const { guess, outcome } = state.labels ?? {};
        if (state.guess === kind) mark(pen, middle, y - half, -1, guess);
        if (wheel.outcome === kind) mark(pen, middle, y + half, 1, outcome);
        x += share;
    }
}

/** A triangle that points at a bar from above (-1) or below (1), and what it says. */
function mark({ ctx, colours, theme, left, wide }, x, edge, way, words = "") {
    const text = theme.text;
    theme.arrowHead(ctx, x, edge + 0.15 * way * text, 0, -way, 0.65 * text, colours.ink);
    const middle = Math.max(left + 2.5 * text, Math.min(left + wide - 2.5 * text, x));
    const how = { colour: colours.ink, align: "center", size: 0.9 };
    theme.write(ctx, words, middle, edge + 1.4 * way * text, how);
}
