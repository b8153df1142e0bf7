/** Kicks: the guess, the three kicks of the paper, and what became of the last one. */

import { createDesigner } from "./designer.js";
import { button, choices, element, options, show } from "./dom.js";
import { texts } from "./texts.js";
import { createVerdict } from "./verdict.js";

// The lengths at which the paper's kicks reverse most surely.
const USUAL = [
    { mode: "membrane", ticks: 1 },
    { mode: "position", ticks: 3 },
    { mode: "phase", ticks: 4 },
];

/**
 * @param {HTMLElement} root
 * @param {import("./lab.js").Lab} lab
 * @returns {{update: () => void, verdict: object}}
 */
export function createKicks(root, lab) {
    const guess = choices(
        "guess",
        texts.guess,
        ["reverses", "continues", "stops", null].map((value) => ({
            value,
            label: texts.guesses[value ?? "none"],
        })),
        null,
    );
    guess.classList.add("guess");
    const wheel = choices("wheel", texts.whichWheel, options(texts.wheelChoices), "both");
    wheel.classList.add("inline");
    const verdict = createVerdict(lab);

    const kick = async (fields) => {
        const { robot } = lab.store;
        const guessed = guess.value;
        const done = await lab.try("kick", { ...fields, wheel: wheel.value, guess: guessed });
        if (!done) return;
        if (guessed) robot.takeVerdict({ type: "guess", kick_id: done.kick_id, guess: guessed });
        guess.choose(null);
    };
    const predict = async (fields) => {
        const kick = { ...fields, wheel: wheel.value };
        const robot = lab.store.robot?.name;
        try {
            verdict.showExpected(kick, await lab.request({ type: "predict", robot, kick }));
        } catch (error) {
            lab.tell(error);
        }
    };

    const three = USUAL.map((fields) => {
        const [name, length, what] = texts.theThree[fields.mode];
        const big = button("", () => kick(fields), "kick");
        big.id = `kick-${fields.mode}`;
        big.append(element("b", {}, name), element("span", {}, length), element("small", {}, what));
        return big;
    });
    const resting = element("p", { className: "resting" }, texts.startFirst);
    const controls = element("fieldset", { className: "bare" });
    const designer = createDesigner(lab, kick, predict);
    controls.append(
        guess,
        wheel,
        element("div", { className: "three" }, resting, ...three),
        verdict.root,
        designer.root,
    );
    controls.setAttribute("aria-describedby", "who-drives");
    root.append(controls);

    const update = () => {
        const { robot, mayDrive } = lab.store;
        const runs = robot?.state === "running";
        for (const field of [...three, designer.commands]) field.disabled = !(mayDrive && runs);
        guess.disabled = wheel.disabled = !mayDrive;
        show(resting, Boolean(robot) && mayDrive && !runs);
        if (robot) {
            designer.update(robot);
            verdict.update(robot);
        }
    };
    return { update, verdict };
}
