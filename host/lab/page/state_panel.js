/** What the robot says of itself. */

import { button, element, setText, show } from "./dom.js";
import { whyOf } from "./now.js";
import { texts } from "./texts.js";
import { sentences } from "./words.js";

/**
 * @param {HTMLElement} root
 * @param {import("./lab.js").Lab} lab
 * @returns {() => void} Brings the panel up to date.
 */
export function createState(root, lab) {
    const list = element("dl");
    const values = {};
    for (const [name, text] of Object.entries(texts.facts)) {
        values[name] = element("dd");
        list.append(element("div", {}, element("dt", {}, text), values[name]));
    }
    values.unattended.parentElement.classList.add("unattended");
    const ask = async () => {
        if (await lab.try("identify")) lab.tell(texts.identified);
    };
    const identify = button(texts.identify, ask, "identify");
    const takeOver = button("", () => lab.try("take_over"));
    show(takeOver, false);
    root.append(list, takeOver, identify);

    return () => {
        const { robot, welcome, mayDrive, page } = lab.store;
        identify.disabled = !mayDrive;
        if (!robot) return;
        const { info, status } = robot;
        const facts = {
            label: texts.robotLabel(robot.name, info.label),
            address: info.uri,
            motor: info.motor || texts.unknown,
            battery: status.battery_v > 0 ? texts.volts(status.battery_v) : texts.unknown,
            punctual: texts.punctual(status),
            driver: status.controller ?? texts.nobody,
            unattended: texts.unattended[welcome.unattended?.[robot.name]] ?? texts.unknown,
            reason: robot.lost
                ? sentences(texts.reason(status, page), status.hint)
                : whyOf(robot, lab.store),
            missed: String(robot.missed),
        };
        for (const [name, value] of Object.entries(facts)) setText(values[name], value);
        show(values.missed.parentElement, robot.missed > 0);
        show(values.reason.parentElement, robot.lost || robot.state !== "running");
        show(takeOver, Boolean(status.controller) && status.here === false);
        setText(takeOver, texts.takeOver(status.controller));
        takeOver.disabled = !mayDrive;
        root.classList.toggle("stale", robot.lost);
    };
}
