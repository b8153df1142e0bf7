/** The top of the page: which robot is shown, what it does, and the button that helps. */

import { besideTexts } from "./beside_texts.js";
import { button, byId, element, setText, show } from "./dom.js";
import { texts } from "./texts.js";
import { sentences } from "./words.js";

/**
 * @param {import("./lab.js").Lab} lab
 * @returns {() => void} Brings the top up to date.
 */
export function createNow(lab) {
    const [tabs, root] = [byId("robots"), byId("now")];
    const state = element("b", { className: "state" });
    const reason = element("span", { className: "reason" });
    const remedy = button("", () => help(), "remedy");
    const help = () => {
        const straight = remedy.value === "start" && lab.store.straight;
        return straight ? lab.try("primitive", { name: "straight" }) : lab.try(remedy.value);
    };
    root.append(state, reason, remedy);
    let filled = null;
    let buttons = [];

    const select = (index) => {
        lab.store.selected = index;
        lab.changed = true;
    };

    return () => {
        const { robots, robot, mayDrive, page, held, still } = lab.store;
        if (filled !== robots) {
            filled = robots;
            buttons = robots.map(({ name }, index) => button(name, () => select(index)));
            tabs.replaceChildren(...buttons);
            show(tabs, robots.length > 1);
        }
        buttons.forEach((tab, index) => {
            tab.setAttribute("aria-current", String(robots[index] === robot));
            tab.dataset.state = shownState(robots[index]);
        });
        show(root, Boolean(robot));
        if (!robot) return;
        const is = shownState(robot);
        root.dataset.state = is;
        setText(state, texts.states[is]);
        let helps = is === "lost" ? null : robot.status.remedy;
        let why = is === "lost" ? texts.lostFor(robot.lostFor()) : whyOf(robot.status, page);
        if (helps === "start" && (held || still)) {
            [helps, why] = [null, held ? texts.startsAfterPrediction : texts.staysStill];
        }
        setText(reason, why);
        show(remedy, Boolean(helps));
        remedy.value = helps ?? "";
        const words = texts.remedies[helps] ?? "";
        setText(remedy, robots.length > 1 ? besideTexts.remedy(words, robot.name) : words);
        remedy.disabled = !mayDrive;
    };
}

/** @returns {string} What a robot does, as a key of `texts.states`. */
export function shownState(robot) {
    return robot.lost ? "lost" : robot.state;
}

/** @returns {string} Why a robot does not run, in sentences; empty if it does. */
export function whyOf(status, page) {
    if (status.state === "running") return "";
    return sentences(texts.reason(status, page), status.hint);
}
