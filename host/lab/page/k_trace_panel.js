/** The trace that moving k leaves: its drawing, its description, and the button that clears it. */

import { button } from "./dom.js";
import { draw } from "./draw/k_trace.js";
import { KTrace } from "./k_trace.js";
import { texts } from "./texts.js";
import { sentences } from "./words.js";

/**
 * @param {HTMLElement} root
 * @param {HTMLCanvasElement} canvas
 * @param {import("./lab.js").Lab} lab
 * @returns {{draw: Function, view: () => object, update: () => void, state: () => object[]}}
 *     `state` gives the marks as plain data.
 */
export function createKTrace(root, canvas, lab) {
    const view = { holds: [], labels: texts.kTraceLabels, stale: false };
    let trace = null;
    const clear = button(texts.kTraceClear, () => {
        trace?.clear();
        lab.changed = true;
    });
    root.append(clear);

    const update = () => {
        const { robot, link } = lab.store;
        if (!robot) return;
        if (trace?.robot.name !== robot.name) trace = new KTrace(robot);
        trace.robot = robot; // after a lost link it is another object
        trace.update();
        view.holds = trace.holds;
        view.stale = !link.up || robot.lost;
        clear.disabled = trace.holds.length < 2;
        const last = trace.holds.findLast(({ means }) => means.left);
        canvas.setAttribute(
            "aria-label",
            sentences(texts.kTraceAlt, last && texts.kTraceHold(last)),
        );
    };
    return { draw, view: () => view, update, state: () => trace?.holds ?? [] };
}
