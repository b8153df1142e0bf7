/** What a screen reader hears: kicks and outcomes, faults, and robots that come and go. */

import { besideTexts } from "./beside_texts.js";
import { byId } from "./dom.js";
import { texts } from "./texts.js";

/** @param {import("./lab.js").Lab} lab */
export function createSaid(lab) {
    const region = byId("said");
    const before = new Map();
    // Whether the link is lost that there once was.
    let away = false;

    const say = (words) => {
        region.textContent = words;
    };

    const named = (name, words) =>
        say(lab.store.robots.length > 1 ? besideTexts.named(name, words) : words);

    lab.listeners.push((message) => {
        const { type, robot } = message;
        if (type === "event" && message.event.event === "kick") {
            named(robot, texts.said.kick(message.event.kick));
        } else if (type === "outcome") {
            named(robot, texts.said.outcome(message));
        } else if (type === "twin") {
            say(besideTexts.compared(message, robot));
        } else if (type === "state") {
            const now = message.link === "lost" ? "lost" : message.state;
            const then = before.get(robot);
            before.set(robot, now);
            if (lab.store.byName(robot)?.unseen) before.delete(robot);
            if (now === then || then === undefined) return;
            if (now === "lost") say(texts.said.lost(robot));
            else if (now === "fault") say(texts.said.fault(robot, message.reason));
            else if (then === "lost") say(texts.said.found(robot));
        } else if (type === "link" && away === message.up) {
            away = !message.up && lab.store.link.ever;
            if (message.up || away) say(message.up ? texts.said.labFound : texts.said.labLost);
        }
    });
}
