/**
 * Basins of attraction: where each start of a grid leads, by colour and by pattern.
 *
 * Lines rise where it leads forward, and fall where it leads backward. Dots mean rest, and nothing
 * that it leads to no end. A line parts what leads to different ends.
 */

const NAMES = { f: "forward", b: "backward", r: "rest" };
// How much of its colour an area has, and its pattern: the traces on it count more.
const TINT = 0.14;
const PATTERN = 0.5;

/**
 * @typedef {Object} BasinsState
 * @property {number} side how many cells there are along each axis
 * @property {string} ends where each cell leads: f(orward), b(ackward), r(est) or n(either), row
 *     by row from the lowest, each from the left
 * @property {boolean} stale whether this is no longer up to date
 */

/**
 * Draw basins over a whole canvas.
 *
 * @param {HTMLCanvasElement} canvas its width and height are device pixels
 * @param {BasinsState} state what is not known may be missing
 * @param {Object} theme see theme.js
 */
export function draw(canvas, state, theme) {
    const { ctx, width, height, colours } = theme.start(canvas, state.stale);
    const { side = 0, ends = "" } = state;
    const end = (column, row) => ends[row * side + column];
    // Cells end at whole pixels, or their seams would be seen.
    const place = (n, pixels) => Math.round((n * pixels) / side) / theme.scale;
    const across = (column) => place(column, canvas.width);
    const up = (row) => height - place(row, canvas.height);
    // Cells of one row that lead to the same end; few large areas are painted faster.
    const runs = [];
    for (let row = 0; row < side; row++) {
        for (let from = 0, to = 1; from < side; from = to++) {
            while (to < side && end(to, row) === end(from, row)) to++;
            runs.push({ row, from, to, end: end(from, row) });
        }
    }
    for (const [letter, name] of Object.entries(NAMES)) {
        ctx.save();
        ctx.beginPath();
        for (const { row, from, to, end } of runs) {
            if (end !== letter) continue;
            ctx.rect(across(from), up(row + 1), across(to) - across(from), up(row) - up(row + 1));
        }
        ctx.clip();
        ctx.strokeStyle = ctx.fillStyle = colours[name];
        ctx.globalAlpha = TINT;
        ctx.fillRect(0, 0, width, height);
        ctx.globalAlpha = PATTERN;
        pattern(ctx, letter, 0.75 * theme.text, width, height);
        ctx.restore();
    }
    ctx.strokeStyle = colours.ink;
    ctx.lineWidth = 0.7 * theme.line;
    ctx.beginPath();
    for (const { row, from, to, end: own } of runs) {
        if (to < side) {
            ctx.moveTo(across(to), up(row));
            ctx.lineTo(across(to), up(row + 1));
        }
        for (let column = from; row + 1 < side && column < to; column++) {
            if (end(column, row + 1) === own) continue;
            ctx.moveTo(across(column), up(row + 1));
            ctx.lineTo(across(column + 1), up(row + 1));
        }
    }
    ctx.stroke();
}

function pattern(ctx, letter, gap, width, height) {
    ctx.beginPath();
    if (letter === "r") {
        ctx.lineWidth = 2;
        ctx.setLineDash([0, gap]);
        for (let n = 0; n * gap < 2 * height; n++) {
            ctx.moveTo(((n % 2) * gap) / 2, (n * gap) / 2);
            ctx.lineTo(width, (n * gap) / 2);
        }
    } else {
        ctx.lineWidth = 1;
        const [from, to] = letter === "f" ? [height, 0] : [0, height];
        for (let x = -height; x < width; x += gap) {
            ctx.moveTo(x, from);
            ctx.lineTo(x + height, to);
        }
    }
    ctx.stroke();
}
