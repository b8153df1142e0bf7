/** Motion primitives, and the settings of the paper. */

import { button, element, setText, show } from "./dom.js";
import { texts } from "./texts.js";

/**
 * @param {HTMLElement} root
 * @param {import("./lab.js").Lab} lab
 * @returns {() => void} Brings the panel up to date.
 */
export function createMovements(root, lab) {
    const primitives = group(texts.primitives);
    const presets = group(texts.presets);
    const note = element("p", { className: "fine", role: "status" }, texts.moveNote);
    root.append(primitives, note, presets);
    let filled = null;
    let underway = false;

    const move = async (name) => {
        underway = lab.changed = true;
        const result = await lab.try("primitive", { name });
        underway = false;
        if (result?.reached === false) lab.tell(texts.notReached(name));
        lab.changed = true;
    };

    return () => {
        const { welcome, mayDrive, robot } = lab.store;
        if (welcome && filled !== welcome) {
            filled = welcome;
            fill(primitives, welcome.primitives, (name) => move(name));
            fill(presets, welcome.presets, (name) => lab.try("preset", { name }));
        }
        presets.disabled = !mayDrive;
        primitives.disabled = !mayDrive || underway || robot?.state !== "running";
        setText(note, underway ? texts.moving : texts.moveNote);
    };
}

function group(legend) {
    return element("fieldset", { className: "buttons" }, element("legend", {}, legend));
}

function fill(fieldset, rows, act) {
    for (const old of fieldset.querySelectorAll("button")) old.remove();
    fieldset.append(...rows.map(({ name, label }) => button(label, () => act(name))));
}
