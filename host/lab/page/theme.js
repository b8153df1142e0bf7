/**
 * What all drawings of the lab look like: colours, sizes, and the few tools that they share.
 *
 * A drawing imports nothing. It gets the theme as an argument, and with it everything else.
 */

// `rim`, `grid` and `band` are decoration. What carries meaning has a contrast of 3:1 to the paper,
// what is read has 4.5:1.
const LIGHT = {
    paper: "#fdfcfa",
    ink: "#1b1d20",
    faint: "#585d64",
    axis: "#7b8087",
    grid: "#e4e2dc",
    rim: "#efede7",
    band: "#e9e4d4",
    rod: "#74797f",
    target: "#008060",
    actual: "#c85a00",
    memory: "#8e3fa8",
    force: "#0059b3",
    kick: "#c3122f",
    left: "#1b1d20",
    right: "#787d84",
    left1: "#7d3f00",
    left2: "#d07500",
    right1: "#004f9e",
    right2: "#008fb3",
    reverses: "#b0125b",
    continues: "#00628f",
    stops: "#6b7077",
    forward: "#2a7f62",
    backward: "#8f56a8",
    rest: "#6b7077",
    raised: "#b3441e",
    lowered: "#1f5fa8",
};
const DARK = {
    paper: "#14171a",
    ink: "#efede7",
    faint: "#a9aeb5",
    axis: "#858b93",
    grid: "#2a2f35",
    rim: "#22262b",
    band: "#2f3036",
    rod: "#9aa0a8",
    target: "#34c794",
    actual: "#ff9838",
    memory: "#d796ee",
    force: "#6db1ff",
    kick: "#ff6f80",
    left: "#efede7",
    right: "#9298a0",
    left1: "#c98544",
    left2: "#ffcf87",
    right1: "#5b9dff",
    right2: "#66dcea",
    reverses: "#ff7fb4",
    continues: "#5fb9ea",
    stops: "#a9aeb5",
    forward: "#4fbf97",
    backward: "#c08adc",
    rest: "#a9aeb5",
    raised: "#ff9a6b",
    lowered: "#74b4ff",
};
const DECORATION = ["paper", "grid", "rim", "band"];
const FAMILY = '"Helvetica Neue", "Liberation Sans", Arial, "DejaVu Sans", sans-serif';
const SYMBOLS = '"STIX Two Text", "Times New Roman", "Liberation Serif", "DejaVu Serif", serif';
const TEXT = 13;
// A text on a projector is read from the last row if it is this part of the screen's height.
const PROJECTED = 1 / 40;

/**
 * How a page is shown.
 *
 * @typedef {Object} Media
 * @property {boolean} dark whether on a dark ground
 * @property {number} scale device pixels per CSS pixel
 * @property {number} height of the window, CSS pixels
 */

/**
 * @typedef {Object} Theme
 * @property {Object<string, string>} colours by name, as `#rrggbb`
 * @property {Object<string, string>} grey the same names, for what is no longer up to date
 * @property {number} scale device pixels per CSS pixel
 * @property {number} text height of the text, CSS pixels
 * @property {number} legible a smaller text cannot be read from where people are, CSS pixels
 * @property {number} least no text is smaller than this, in heights of the text
 * @property {number} line width of an ordinary line, CSS pixels
 * @property {number[]} dash of a dashed line, for setLineDash
 * @property {function} start see `start`
 * @property {function} write see `write`
 * @property {function} run see `run`
 * @property {function} measure see `measure`
 * @property {function} rule see `rule`
 * @property {function} arrowHead see `arrowHead`
 * @property {function} ticks see `ticks`
 * @property {function} number see `number`
 */

/**
 * How this window is shown.
 *
 * @param {Window} view the window
 * @param {?string} choice `light`, `dark`, or null for what the system says
 * @returns {Media}
 */
export function media(view, choice = null) {
    return {
        dark: choice ? choice === "dark" : view.matchMedia("(prefers-color-scheme: dark)").matches,
        scale: view.devicePixelRatio || 1,
        height: view.innerHeight,
    };
}

/**
 * Colours and sizes.
 *
 * @param {Media} media how the page is shown
 * @param {boolean} projector whether people look at it from afar
 * @returns {Theme}
 */
export function theme({ dark, scale, height }, projector = false) {
    const colours = dark ? DARK : LIGHT;
    const grey = {};
    for (const [name, colour] of Object.entries(colours)) {
        grey[name] = DECORATION.includes(name) ? colour : colours.faint;
    }
    const text = projector ? Math.max(TEXT, height * PROJECTED) : TEXT;
    const line = text / 8;
    const dash = [3 * line, 2 * line];
    const [least, legible] = projector ? [1, text] : [0, 0];
    const tools = { start, write, run, measure, rule, arrowHead, ticks, number };
    return { colours, grey, scale, text, legible, least, line, dash, ...tools };
}

/**
 * A theme for a drawing: a small one has a smaller text.
 *
 * @param {Theme} theme the page's
 * @param {HTMLCanvasElement} canvas the drawing's
 * @param {number} letters for how many letters' heights it needs room in a line
 * @param {number} lines for how many lines it needs room
 * @returns {Theme}
 */
export function fitted(theme, canvas, letters, lines) {
    const room = Math.min(canvas.clientWidth / letters, canvas.clientHeight / lines);
    const text = Math.min(theme.text, room);
    return text < theme.text ? { ...theme, text } : theme;
}

/**
 * Begin a drawing: an empty sheet in CSS pixels.
 *
 * @param {HTMLCanvasElement} canvas its width and height are device pixels
 * @param {boolean} stale whether what it shows is no longer up to date
 * @returns {{ctx: CanvasRenderingContext2D, width: number, height: number, colours: Object}}
 *     width and height in CSS pixels
 */
function start(canvas, stale) {
    const ctx = canvas.getContext("2d", { alpha: false });
    const colours = stale ? this.grey : this.colours;
    const width = canvas.width / this.scale;
    const height = canvas.height / this.scale;
    ctx.setTransform(this.scale, 0, 0, this.scale, 0, 0);
    ctx.globalAlpha = 1;
    ctx.setLineDash([]);
    ctx.lineJoin = "round";
    ctx.lineCap = "round";
    ctx.fillStyle = colours.paper;
    ctx.fillRect(0, 0, width, height);
    return { ctx, width, height, colours };
}

/**
 * Write a text.
 *
 * @param {CanvasRenderingContext2D} ctx where
 * @param {string} text what
 * @param {number} x where it is aligned, CSS pixels
 * @param {number} y its middle, CSS pixels
 * @param {Object} how colour; align: left, center or right; size: 1 is the theme's; bold; symbol:
 *     italics for a quantity; halo: the colour of a rim around the letters
 */
function write(ctx, text, x, y, how) {
    ctx.font = font(this, how);
    ctx.textAlign = how.align ?? "left";
    ctx.textBaseline = "middle";
    if (how.halo) {
        ctx.strokeStyle = how.halo;
        ctx.lineWidth = this.text / 3;
        ctx.strokeText(text, x, y);
    }
    ctx.fillStyle = how.colour;
    ctx.fillText(text, x, y);
}

/** Write a text as `write` does. Returns its width, CSS pixels; to know that takes longer. */
function run(ctx, text, x, y, how) {
    this.write(ctx, text, x, y, how);
    return ctx.measureText(text).width;
}

/** How wide a text is that `write` writes so, CSS pixels. */
function measure(ctx, text, how) {
    ctx.font = font(this, how);
    return ctx.measureText(text).width;
}

function font(theme, { size = 1, bold = false, symbol = false }) {
    const height = Math.max(size, theme.least) * theme.text * (symbol ? 1.12 : 1);
    const style = (symbol ? "italic " : "") + (bold ? "bold " : "");
    return `${style}${height}px ${symbol ? SYMBOLS : FAMILY}`;
}

/**
 * Draw a level line.
 *
 * @param {CanvasRenderingContext2D} ctx where
 * @param {number} from its left end, CSS pixels
 * @param {number} to its right end, CSS pixels
 * @param {number} y its height, CSS pixels
 * @param {string} colour its colour
 * @param {boolean} dashed whether it is dashed
 */
function rule(ctx, from, to, y, colour, dashed) {
    ctx.beginPath();
    ctx.moveTo(from, y);
    ctx.lineTo(to, y);
    ctx.strokeStyle = colour;
    ctx.lineWidth = this.line;
    if (dashed) ctx.setLineDash(this.dash);
    ctx.stroke();
    ctx.setLineDash([]);
}

/**
 * Draw the head of an arrow.
 *
 * @param {CanvasRenderingContext2D} ctx where
 * @param {number} x its tip, CSS pixels
 * @param {number} y its tip, CSS pixels
 * @param {number} right where it points: a unit vector on the screen
 * @param {number} down where it points
 * @param {number} long its length, CSS pixels
 * @param {string} colour its colour
 */
function arrowHead(ctx, x, y, right, down, long, colour) {
    const half = 0.45 * long;
    ctx.beginPath();
    ctx.moveTo(x, y);
    ctx.lineTo(x - long * right + half * down, y - long * down - half * right);
    ctx.lineTo(x - long * right - half * down, y - long * down + half * right);
    ctx.fillStyle = colour;
    ctx.fill();
}

/**
 * Round numbers along an axis.
 *
 * @param {number} low its lower end
 * @param {number} high its upper end
 * @param {number} most how many at most
 * @param {number} unit the step is a round number of this, such as pi
 * @returns {number[]}
 */
function ticks(low, high, most, unit = 1) {
    const least = (high - low) / unit / Math.max(1, most);
    if (!(least > 0 && least < Infinity)) return [];
    const power = 10 ** Math.floor(Math.log10(least));
    const steps = unit === 1 ? [1, 2, 5, 10] : [1, 2.5, 5, 10];
    const step = unit * power * steps.find((factor) => factor * power >= least * (1 - 1e-9));
    const values = [];
    for (let n = Math.ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; n++) {
        values.push(n * step);
    }
    return values;
}

/**
 * A number as people write it.
 *
 * @param {number} value the number
 * @param {number} digits behind the point
 * @param {boolean} sign whether a positive one has its sign, too
 * @returns {string} a dash if there is no number
 */
function number(value, digits = 0, sign = false) {
    if (!Number.isFinite(value)) return "–";
    const size = Math.abs(value).toFixed(digits);
    const zero = Number(size) === 0;
    if (value < 0 && !zero) return "−" + size;
    return (sign && !zero ? "+" : "") + size;
}
