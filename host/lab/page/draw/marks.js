/**
 * Marks over a time slider: kicks as triangles with a bar as long as they act, faults as crosses,
 * stops as squares, missing ticks as hatched columns, ticks that are not as computed as ≠, and
 * everything else as a short line.
 */

/**
 * @typedef {Object} MarksState
 * @property {{place: number, ticks: number, kind: string}[]} marks in which record, how long, what
 * @property {number} count how many records there are
 * @property {number} edge from the canvas's edge to the middle of the slider's thumb at its ends,
 *     CSS pixels
 */

/**
 * Draw the marks.
 *
 * @param {HTMLCanvasElement} canvas its width and height are device pixels
 * @param {MarksState} state
 * @param {Object} theme see theme.js
 */
export function draw(canvas, { marks, count, edge }, theme) {
    const { ctx, width, height, colours } = theme.start(canvas, false);
    const unit = (width - 2 * edge) / Math.max(1, count - 1);
    const size = Math.min(height / 2, 0.8 * theme.text) / 2;
    const middle = height / 2;
    const order = ["other", "start", "stop", "missing", "kick", "fault", "differs"];
    const sorted = [...marks].sort((a, b) => order.indexOf(a.kind) - order.indexOf(b.kind));
    for (const { place, ticks, kind } of sorted) {
        const x = edge + place * unit;
        const shape = SHAPES[kind] ?? SHAPES.other;
        ctx.lineWidth = theme.line;
        shape({ ctx, colours, theme, x, middle, size, height, long: Math.max(1, ticks * unit) });
    }
}

const SHAPES = {
    kick({ ctx, colours, x, middle, size, height, long }) {
        ctx.fillStyle = colours.kick;
        ctx.fillRect(x, middle + size, long, height);
        ctx.beginPath();
        ctx.moveTo(x, middle + 1.5 * size);
        ctx.lineTo(x - size, middle - size);
        ctx.lineTo(x + size, middle - size);
        ctx.fill();
    },
    fault({ ctx, colours, theme, x, middle, size }) {
        ctx.strokeStyle = colours.kick;
        ctx.lineWidth = 1.5 * theme.line;
        ctx.beginPath();
        for (const way of [-1, 1]) {
            ctx.moveTo(x - size, middle - way * size);
            ctx.lineTo(x + size, middle + way * size);
        }
        ctx.stroke();
    },
    stop({ ctx, colours, x, middle, size }) {
        ctx.fillStyle = colours.ink;
        ctx.fillRect(x - 0.8 * size, middle - 0.8 * size, 1.6 * size, 1.6 * size);
    },
    start({ ctx, colours, x, middle, size }) {
        ctx.fillStyle = colours.target;
        ctx.beginPath();
        ctx.moveTo(x + size, middle);
        ctx.lineTo(x - 0.7 * size, middle - size);
        ctx.lineTo(x - 0.7 * size, middle + size);
        ctx.fill();
    },
    missing({ ctx, colours, x, size, height }) {
        ctx.strokeStyle = colours.faint;
        ctx.beginPath();
        for (let y = 0; y < height; y += 0.8 * size) {
            ctx.moveTo(x - 0.6 * size, y + 0.6 * size);
            ctx.lineTo(x + 0.6 * size, y);
        }
        ctx.stroke();
    },
    differs({ ctx, colours, theme, x, middle }) {
        const how = { colour: colours.kick, align: "center", bold: true, halo: colours.paper };
        theme.write(ctx, "≠", x, middle, how);
    },
    other({ ctx, colours, x, middle, size }) {
        ctx.fillStyle = colours.faint;
        ctx.fillRect(x - 0.5, middle - size, 1, 2 * size);
    },
};
