/** The words of robots and twins beside each other. */

import { atRest, texts } from "./texts.js";
import { counted, sentences } from "./words.js";

const even = (deeds) => new Set(deeds.map(([, word]) => word)).size === 1;
const deedsOf = ({ before, result }) =>
    Object.entries(result).map(([side, word]) => [side, atRest(before, side)[word]]);

const didWhat = (deeds) => {
    if (deeds.length > 1 && even(deeds)) return `both wheels ${deeds[0][1]}`;
    const each = ([side, word]) => `${texts.sides[side].toLowerCase()} wheel ${word}`;
    return deeds.map(each).join(", ");
};

/** What came of a kick, in fewer words than in the panel of kicks. */
const cameOf = (outcome) =>
    outcome.why ? texts.noOutcome(outcome.why) : didWhat(deedsOf(outcome));

export const besideTexts = {
    title: "All robots",
    below: "More below ↓",
    toggle: "Side by side",
    toggleLabel: "Side by side: all robots and their twins at once",
    here: "Kicks go here",
    choose: "Kick this one",
    shown: "Known",
    look: "Choose this one",
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
    twinsPlane: "a twin has no basins",
    othersPlane: "basins once chosen",
    computing: "basins: computing …",
    noBasins: "no basins",
    lastKick: (kick, outcome) => sentences(texts.lastKick(kick), outcome && cameOf(outcome)),
    compared: ({ robot_did, twin_did }, name) => {
        const [own, other] = [robot_did, twin_did].map((did) => didWhat(deedsOf(did)));
        return own === other
            ? `Last kick, ${name} and its twin: ${own}.`
            : `Last kick, ${name}: ${own}; its twin: ${other}.`;
    },
    score: ({ same, kicks }) =>
        kicks ? `The same after ${same} of ${counted(kicks, "kick", "kicks")}.` : "",
};
