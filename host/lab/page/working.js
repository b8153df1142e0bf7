/**
 * The equations of the tick at the cursor, with its numbers in them. The lines and all numbers come
 * with the tape: this puts the ones into the others, and compares with what the robot has logged.
 */

import { byId, element, setText } from "./dom.js";
import { words } from "./replay_texts.js";
import { STATES } from "./robot_view.js";

const SIDES = ["left", "right"];
// How a tick compares, as its channel `compared` has it.
const ROUNDED = 2;
const DIFFERENT = 3;
// A name of a channel in the numbers of a line.
const NAMED = /\{(\w+)\}/g;

/**
 * @param {HTMLElement} root
 * @param {object} tape
 * @param {import("./recorded.js").RecordedRobot} robot
 * @returns {{update: (place: number) => void, state: () => object}}
 */
export function createWorking(root, tape, robot) {
    const { columns } = robot.ring;
    const digits = byId("digits");
    const at = element("p", { className: "at" });
    const verdict = element("p");
    const body = element("tbody");
    const rows = tape.equations.left.map((line, n) => {
        const [formula, cells] = [element("th", { scope: "row" }), SIDES.map(newCell)];
        const symbol = element("i", {}, ...lowered(line.symbol));
        formula.append(symbol, ` ${line.sign} `, ...lowered(typeset(line.formula)));
        const row = element("tr", {}, formula, ...cells.map(({ root }) => root));
        body.append(row);
        return { row, cells, lines: SIDES.map((side) => tape.equations[side][n]) };
    });
    const heads = [words.quantity, ...SIDES.map((side) => words.sides[side])];
    const head = element("tr", {}, ...heads.map((text) => element("th", { scope: "col" }, text)));
    const table = element("table", {}, element("thead", {}, head), body);
    table.setAttribute("aria-label", words.workingLabel);
    root.append(at, verdict, table, element("p", { className: "fine" }, words.workingNote));
    let shown = null;
    digits.onclick = () => {
        digits.setAttribute("aria-pressed", String(!exact()));
        update(shown);
    };
    const exact = () => digits.getAttribute("aria-pressed") === "true";

    function update(place) {
        shown = place;
        const value = (name) => columns[name][place];
        const since_s = value("t_s") - tape.begin_s;
        setText(at, words.at({ tick: value("tick"), since_s, dt_s: value("dt_s") }));
        const runs = STATES[value("state")] === "running";
        const compared = value("compared");
        setText(verdict, runs || compared === DIFFERENT ? words.compared[compared] : words.off);
        verdict.dataset.compared = compared;
        table.hidden = !runs;
        for (const { row, cells, lines } of runs ? rows : []) {
            lines.forEach((line, n) => fill(cells[n], line, value, exact()));
            row.hidden = cells.every(({ root }) => !root.textContent);
        }
    }

    return {
        update: (place) => place !== shown && update(place),
        state: () => ({
            said: verdict.textContent,
            lines: rows
                .filter(({ row }) => !row.hidden && !table.hidden)
                .map(({ row }) => [...row.cells].map((cell) => cell.textContent)),
        }),
    };
}

function newCell() {
    const [numbers, result, logged] = ["span", "b", "small"].map((tag) => element(tag));
    return { root: element("td", {}, numbers, result, logged), numbers, result, logged };
}

/** Put a tick's numbers into a cell. A line that does not concern this tick leaves it empty. */
function fill({ root, numbers, result, logged }, line, value, exact) {
    const concerns = (!line.when || value(line.when)) && !Number.isNaN(value(line.result));
    const text = (name) => written(value(name), exact);
    const inside = (_, name, at) => bracketed(text(name), line.numbers.slice(0, at));
    const terms = [...line.numbers.matchAll(NAMED)].map(([, name]) => value(name));
    const inserted = terms.some(Number.isNaN)
        ? words.fromTheLog
        : `${typeset(line.numbers.replace(NAMED, inside))} ${line.joint} `;
    setText(numbers, concerns ? inserted : "");
    const unit = line.unit === "1" ? "" : ` ${line.unit}`;
    setText(result, concerns ? typeset(text(line.result)) + unit : "");
    const compares = Boolean(concerns && line.logged && value("compared"));
    const same = compares && Object.is(value(line.result), value(line.logged));
    root.classList.toggle("differs", compares && !same && value("compared") === DIFFERENT);
    const other = () =>
        value("compared") === ROUNDED
            ? words.nearlyLogged
            : words.notLogged(typeset(written(value(line.logged), true)));
    setText(logged, compares ? ` ${same ? words.asLogged : other()}` : "");
}

/**
 * A number in the working: short, or with as many digits as its bits need.
 * @param {number} value
 * @param {boolean} exact
 * @returns {string} With a hyphen as its minus.
 */
function written(value, exact) {
    const all = Object.is(value, -0) ? "-0" : String(value);
    if (exact || all.length <= 6) return all;
    return Math.abs(value) < 1e-3 ? value.toExponential(2) : value.toFixed(4);
}

/** A negative number has brackets behind an operator. */
const bracketed = (text, before) =>
    text.startsWith("-") && /[-+·/] ?$/.test(before) ? `(${text})` : text;
/** The parts of a text; what stands behind an underscore stands lower. */
const lowered = (text) =>
    text.split(/_(\w+)/).map((part, n) => (n % 2 ? element("sub", {}, part) : part));
const typeset = (text) => text.replaceAll("-", "−");
