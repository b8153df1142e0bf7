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
    const cells = [];
    for (let row = 0; row < side; row++) {
        const [low, high] = [row, row + 1].map((n) => height - place(n, canvas.height));
        for (let column = 0; column < side; column++) {
            const [left, right] = [column, column + 1].map((n) => place(n, canvas.width));
            cells.push({ column, row, left, right, low, high, end: end(column, row) });
        }
    }
    for (const [letter, name] of Object.entries(NAMES)) {
        ctx.save();
        ctx.beginPath();
        for (const { left, right, low, high, end } of cells) {
            if (end === letter) ctx.rect(left, high, right - left, low - high);
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
    for (const { column, row, left, right, low, high, end: own } of cells) {
        if (column + 1 < side && end(column + 1, row) !== own) {
            ctx.moveTo(right, low);
            ctx.lineTo(right, high);
        }
        if (row + 1 < side && end(column, row + 1) !== own) {
            ctx.moveTo(left, high);
            ctx.lineTo(right, high);
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
