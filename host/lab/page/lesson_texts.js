/** The words around the guided exercises; their own texts come from the lab. */

import { counted, number } from "./words.js";

export const lessonTexts = {
    button: "Exercises",
    buttonLabel: "Guided exercises: predict, try, check",
    title: "Guided exercises",
    intro: "Each one asks for a prediction first. Nothing moves before it is locked.",
    prediction: "I predict:",
    lock: "Lock my prediction",
    locked: (answer) => `Your prediction is locked: ${answer}.`,
    walls:
        "This exercise needs walls, and a floor on which the tyres do not spin. Ask your" +
        " teacher to end the lab, and to start it by:" +
        " kickctl --brick 'sim://?walls=2&axle=400&grip=1.83&bumper=0.25&idle=1' lab",
    hint: "A hint",
    check: "Check what I did",
    computing: "The wheel is being computed. The first time this takes some seconds …",
    checking: "It is being checked. The first time this takes some seconds …",
    notYet: "Not yet. Go on; what you have done counts.",
    done: "Done.",
    right: (answer) => `You were right: ${answer}.`,
    wrong: (guess, answer) => `You predicted: ${guess}. It is: ${answer}.`,
    misconception: (words) => `What many people think at first: ‘${words}’`,
    ok: "✓",
    missing: "✗",
    next: "Next exercise",
    leave: "Leave the exercise",
};

const MOVED = (times) => `shown ${times} times as fast`;

/** The words about the model wheel of an exercise, by the exercise's name. */
export const modelTexts = {
    label: "Model wheel",
    note: ({ speed }) =>
        `It is computed from the paper's equations, and ${MOVED(speed)}.`,
    rest: {
        symbol: "φ",
        unit: "rad",
        wheels: ["model"],
        name: ({ value }) => `k = ${number(value)}`,
        line: ({ value, seen: [rings_s, size] }) =>
            `k = ${number(value)}: it rings ` +
            (rings_s === null ? "for longer than 40 s" : `for ${number(rings_s, 1)} s`) +
            `; after 40 s its swings have ${number(100 * size, 0)} % of the first one's size`,
        all: () => "",
    },
    twins: {
        symbol: "ln d",
        unit: "",
        wheels: ["model, twin 1", "model, twin 2"],
        name: () => "",
        line: ({ value, seen: [early, late] }) =>
            `pair ${value}: ln d = ${number(early)} at 2 s, ${number(late)} at 12 s`,
        all: (runs) =>
            `mean of ${counted(runs.length, "pair", "pairs")}: ln d =` +
            ` ${number(mean(runs, 0))} at 2 s, ${number(mean(runs, 1))} at 12 s`,
    },
};

function mean(runs, place) {
    return runs.reduce((sum, { seen }) => sum + seen[place], 0) / runs.length;
}
