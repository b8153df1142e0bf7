/** The top of the page: which robot is shown, what it does, and the button that helps. */

import { absentTexts } from "./absent_texts.js";
import { besideTexts } from "./beside_texts.js";
import { button, byId, element, setText, show } from "./dom.js";
import { texts } from "./texts.js";
import { sentences } from "./words.js";

// A longer name has no room in a button between all others.
const LONGEST_NAME = 16;

/**
 * @param {import("./lab.js").Lab} lab
 * @returns {() => void} Brings the top up to date.
 */
export function createNow(lab) {
    const [tabs, root] = [byId("robots"), byId("now")];
    const state = element("b", { className: "state" });
    const reason = element("span", { className: "reason" });
    const remedy = button("", () => help(lab, lab.store.robot), "remedy");
    root.append(state, reason, remedy);
    let filled = null;
    let buttons = [];

    const select = (index) => {
        lab.store.selected = index;
        lab.changed = true;
    };

    return () => {
        const { robots, robot, mayDrive } = lab.store;
        const several = robots.length > 1;
        if (filled !== robots) {
            filled = robots;
            buttons = robots.map(({ name }, index) => button(name, () => select(index)));
            tabs.replaceChildren(...buttons);
            show(tabs, several);
            root.classList.toggle("several", several);
        }
        buttons.forEach((tab, index) => {
            tab.setAttribute("aria-current", String(robots[index] === robot));
            tab.dataset.state = shownState(robots[index]);
        });
        show(root, Boolean(robot));
        if (!robot) return;
        const is = shownState(robot);
        root.dataset.state = is;
        setText(state, stateWord(robot));
        const helps = remedyOf(robot, lab.store);
        setText(reason, is === "lost" ? lostWords(robot) : whyOf(robot, lab.store));
        // Of several, it keeps its room: names must not wrap when a robot stops.
        show(remedy, several || Boolean(helps));
        remedy.style.visibility = helps ? "" : "hidden";
        const words = texts.remedies[helps ?? "start"];
        const label = several ? besideTexts.remedy(words, robot.name) : words;
        remedy.setAttribute("aria-label", label);
        setText(remedy, robot.name.length > LONGEST_NAME ? words : label);
        remedy.disabled = !mayDrive;
    };
}

/**
 * Do what makes a robot run again, or leads there.
 * @param {import("./lab.js").Lab} lab
 * @param {import("./robot_view.js").RobotView} robot
 */
export function help(lab, robot) {
    const { remedy } = robot.status;
    const straight = remedy === "start" && lab.store.straight;
    if (straight) lab.tryEach([robot], "primitive", { name: "straight" });
    else lab.tryEach([robot], remedy);
}

/** @returns {?string} The command that helps a robot now, as a key of `texts.remedies`. */
export function remedyOf(robot, { held, still }) {
    if (robot.lost) return null;
    const { remedy = null } = robot.status;
    return remedy === "start" && (held || still) ? null : remedy;
}

/** @returns {string} What a robot does, in a word or two. */
export function stateWord(robot) {
    return robot.unseen ? absentTexts.unseen : texts.states[shownState(robot)];
}

/** @returns {string} What is known of a robot that does not answer. */
export function lostWords(robot) {
    if (robot.unseen) return sentences(absentTexts.notThere, robot.status.hint);
    const seconds = robot.lostFor();
    const before = robot.state === "stopped" ? absentTexts.hadStopped(seconds) : "";
    return sentences(before, texts.lostFor(seconds));
}

/** @returns {string} What a robot does, as a key of `texts.states`. */
export function shownState(robot) {
    return robot.lost ? "lost" : robot.state;
}

/**
 * @param {import("./robot_view.js").RobotView} robot One that is not lost.
 * @param {import("./store.js").Store} store
 * @returns {string} Why it does not run, in sentences; empty if it does.
 */
export function whyOf({ status }, { page, held, still }) {
    if (status.state === "running") return "";
    // What to do would be to press Start, which is hidden.
    if (status.remedy === "start" && held) return texts.startsAfterPrediction;
    if (status.remedy === "start" && still) return texts.staysStill;
    return sentences(texts.reason(status, page), status.hint);
}
