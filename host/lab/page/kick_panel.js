/** Kicks: the guess, the three kicks of the paper, and what became of the last one. */

import { absentTexts } from "./absent_texts.js";
import { besideTexts } from "./beside_texts.js";
import { createDesigner } from "./designer.js";
import { button, choices, element, options, setText, show } from "./dom.js";
import { createExpectation } from "./expectation.js";
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
 * @returns {{update: () => void, verdict: object, usual: object[], wheel: () => string}}
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
        () => (lab.changed = true),
    );
    guess.classList.add("guess");
    const wheel = choices("wheel", texts.whichWheel, options(texts.wheelChoices), "both", () => {
        lab.changed = true;
    });
    wheel.classList.add("inline");
    const verdict = createVerdict(lab);

    const kick = async (fields) => {
        const { targets } = lab.store;
        const guessed = guess.value;
        const asked = { ...fields, wheel: wheel.value, guess: guessed };
        const results = await lab.tryEach(targets, "kick", asked);
        targets.forEach((robot, n) => {
            const kick_id = results[n]?.kick_id;
            if (guessed && kick_id) robot.takeVerdict({ type: "guess", kick_id, guess: guessed });
        });
        if (results.some(Boolean)) guess.choose(null);
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

    const expectation = createExpectation(lab, USUAL);
    const three = USUAL.map((fields) => {
        const big = button("", () => kick(fields), "kick");
        big.id = `kick-${fields.mode}`;
        const [name] = texts.theThree[fields.mode];
        big.append(element("b", {}, name), element("span"), element("small"));
        return big;
    });
    const resting = element("p", { className: "resting" });
    const all = element("input", { type: "checkbox", id: "kick-all" });
    const everyone = element("label", { className: "check" }, all, besideTexts.kickAll);
    all.onchange = () => {
        lab.store.all = all.checked;
        lab.changed = true;
    };
    const controls = element("fieldset", { className: "bare" });
    const designer = createDesigner(lab, kick, predict);
    controls.append(
        guess,
        wheel,
        everyone,
        element("div", { className: "three" }, resting, ...three),
        verdict.root,
        designer.root,
    );
    controls.setAttribute("aria-describedby", "who-drives");
    root.append(controls);

    const update = () => {
        const { robot, robots, targets, mayDrive, still } = lab.store;
        const absent = targets.filter(({ state, lost }) => lost || state !== "running");
        const runs = absent.length < targets.length;
        for (const field of [...three, designer.commands]) field.disabled = !(mayDrive && runs);
        guess.disabled = wheel.disabled = !mayDrive;
        show(everyone, robots.length > 1);
        const one = targets.length === 1;
        expectation.renew(mayDrive && runs && one && guess.value ? wheel.value : null);
        USUAL.forEach(({ mode }, n) => {
            const [, length, what] = texts.theThree[mode];
            const expected = expectation.of(n);
            const [, beside, below] = three[n].children;
            setText(beside, expected ? texts.expected(expected, wheel.value) : length);
            setText(below, expected ? texts.asExpected : what);
        });
        show(resting, mayDrive && absent.length > 0 && !still);
        // Then a projector shows the kicks all the same.
        resting.classList.toggle("some", runs);
        setText(resting, whyNot(absent, robots.length, targets.length));
        if (robot) {
            designer.update(robot);
            verdict.update(robot);
        }
    };
    return { update, verdict, usual: USUAL, wheel: () => wheel.value };
}

/** Why robots cannot be kicked, in sentences. */
function whyNot(absent, robots, targets) {
    if (robots === 1) return absent.map(absentTexts.notKickedAlone).join("");
    const none = targets > 1 && absent.length === targets ? [absentTexts.noneRuns] : [];
    return [...none, ...absent.map(absentTexts.notKicked)].join(" ");
}
