/** The words of robots and twins beside each other. */

import { atRest, texts } from "./texts.js";
import { counted, sentences } from "./words.js";

const even = (deeds) => new Set(deeds.map(([, word]) => word)).size === 1;
const deedsOf = ({ before, result }) =>
    Object.entries(result).map(([side, word]) => [side, atRest(before, side)[word]]);

/** What came of a kick, in fewer words than in the panel of kicks. */
const cameOf = (outcome) => {
    if (outcome.why) return texts.noOutcome(outcome.why);
    const deeds = deedsOf(outcome);
    return deeds.length > 1 && even(deeds)
        ? `both ${deeds[0][1]}`
        : deeds.map(([side, word]) => `${texts.sides[side].toLowerCase()} ${word}`).join(", ");
};

export const besideTexts = {
    title: "All robots",
    toggle: "Side by side",
    toggleLabel: "Side by side: all robots and their twins at once",
    here: "Kicks go here",
    choose: "Kick this one",
    chooseLabel: (words, name) => `${words}: ${name}`,
    stopLabel: (name) => `STOP ${name}`,
    whose: (name) => `: ${name}`,
    all: "all robots",
    kickAll: "Kick all robots",
    remedy: (words, name) => `${words}: ${name}`,
    named: (name, words) => `${name}: ${words}`,

    twinOf: (name) => `Twin of ${name}`,
    twin: "simulated, the same kicks",
    paused: "Paused",
    noTwin: (why, hint) => sentences(`no twin: ${why}`, hint),
    notPushed: (name) => `A hand or a wall that pushes ${name} does not push its twin.`,
    lastKick: (kick, outcome) => sentences(texts.lastKick(kick), outcome && cameOf(outcome)),
    compared: ({ robot_did, twin_did }, name) => {
        const [own, other] = [deedsOf(robot_did), deedsOf(twin_did)];
        const both = (did, does) => (did === does ? `both ${did}` : `${name} ${did}, twin ${does}`);
        const pairs = own.map(([side, word], n) => [side, both(word, other[n][1])]);
        return even(own) && even(other)
            ? `Last kick: ${pairs[0][1]}.`
            : sentences(...pairs.map(([side, words]) => `${texts.sides[side]}: ${words}`));
    },
    score: ({ same, kicks }) =>
        kicks ? `The same after ${same} of ${counted(kicks, "kick", "kicks")}.` : "",
};
