/** The robot's parameters, from its own table. A change is sent at once. */

import { choices, element, numberInput, setText } from "./dom.js";
import { texts } from "./texts.js";
import { sentences } from "./words.js";

// What the paper varies stands first; the rest is behind a fold.
const FIRST = ["a", "tau_s", "k"];
const SLIDER_STEPS = 200;

/**
 * @param {HTMLElement} root
 * @param {import("./lab.js").Lab} lab
 * @returns {() => void} Brings the panel up to date.
 */
export function createParameters(root, lab) {
    const set = element("fieldset", { className: "bare" });
    root.append(element("p", { className: "fine" }, texts.parametersNote), set);
    let filled = null;
    let rows = [];

    const send = async (row, value) => {
        row.pending = true;
        const done = await lab.try("set", { set: { [row.name]: value } });
        row.pending = false;
        if (!done) row.show(lab.store.robot.status.params[row.name]);
    };

    const fill = (robot) => {
        rows = robot.info.params.map((param) => (param.choices ? choice : number)(param, send));
        const [first, rest] = [[], []];
        for (const row of rows) (FIRST.includes(row.name) ? first : rest).push(row.root);
        const more = element("details", {}, element("summary", {}, texts.more), ...rest);
        set.replaceChildren(...first, more);
    };

    return () => {
        const { robot, mayDrive } = lab.store;
        if (!robot) return;
        if (filled !== robot) fill((filled = robot));
        set.disabled = !mayDrive;
        for (const row of rows) {
            const value = robot.status.params[row.name];
            if (value !== undefined && !row.pending && value !== row.value) row.show(value);
            row.offer(robot.status.accepts?.[row.name] ?? row.all);
        }
    };
}

function choice(param, send) {
    const row = { name: param.name, value: undefined, pending: false, all: param.choices };
    const options = param.choices.map((value) => ({ value, label: String(value) }));
    const group = choices(`param-${param.name}`, param.name, options, param.default, (value) =>
        send(row, value),
    );
    group.append(element("p", { className: "fine" }, sentences(param.doc)));
    row.root = group;
    row.show = (value) => {
        row.value = value;
        group.choose(value);
    };
    row.offer = (accepted) => group.allow((value) => accepted.includes(value));
    return row;
}

function number(param, send) {
    const { name, minimum, maximum } = param;
    const row = { name, value: undefined, pending: false, all: [minimum, maximum] };
    const id = `param-${name}`;
    const field = numberInput({ id, min: minimum, max: maximum, step: "any" });
    const slider = element("input", { type: "range", min: 0, max: SLIDER_STEPS, step: 1 });
    slider.setAttribute("aria-label", name);
    let scale = scaleOf(minimum, maximum);
    const unit = element("span", { className: "unit" }, texts.unit(param.unit));
    const doc = element("p", { className: "fine", id: `${id}-doc` }, texts.paramDoc(param));
    field.setAttribute("aria-describedby", doc.id);
    const label = element("label", { htmlFor: id }, name);
    row.root = element("div", { className: "param" }, label, slider, field, unit, doc);
    row.show = (value) => {
        row.value = value;
        field.value = Number(value.toPrecision(6));
        slider.value = scale.place(value) * SLIDER_STEPS;
        slider.setAttribute("aria-valuetext", `${field.value} ${unit.textContent}`);
    };
    row.offer = ([least, greatest]) => {
        if (Number(field.min) === least && Number(field.max) === greatest) return;
        Object.assign(field, { min: least, max: greatest });
        scale = scaleOf(least, greatest);
        setText(doc, texts.paramDoc({ ...param, minimum: least, maximum: greatest }));
        if (row.value !== undefined) row.show(row.value);
    };
    const take = (value) => {
        row.show(value);
        send(row, value);
    };
    field.onchange = () => take(field.value === "" ? row.value : Number(field.value));
    slider.oninput = () => {
        field.value = scale.value(slider.value / SLIDER_STEPS);
    };
    slider.onchange = () => take(scale.value(slider.value / SLIDER_STEPS));
    return row;
}

/** How a slider's place, 0 to 1, and a value belong together: small values get more room. */
function scaleOf(minimum, maximum) {
    const wide = maximum - minimum;
    return {
        place: (value) => (wide ? Math.sqrt(Math.max(0, value - minimum) / wide) : 0),
        value: (place) =>
            Math.min(
                Math.max(Number((minimum + wide * place * place).toPrecision(3)), minimum),
                maximum,
            ),
    };
}
