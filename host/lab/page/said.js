/** What a screen reader hears: kicks and outcomes, faults, and robots that come and go. */

import { byId } from "./dom.js";
import { texts } from "./texts.js";

/** @param {import("./lab.js").Lab} lab */
export function createSaid(lab) {
    const region = byId("said");
    const before = new Map();

    const say = (words) => {
        region.textContent = words;
    };

    lab.listeners.push((message) => {
        const { type, robot } = message;
        if (type === "event" && message.event.event === "kick") {
            say(texts.said.kick(message.event.kick));
        } else if (type === "outcome") {
            say(texts.said.outcome(message));
        } else if (type === "state") {
            const now = message.link === "lost" ? "lost" : message.state;
            const then = before.get(robot);
            before.set(robot, now);
            if (now === then || then === undefined) return;
            if (now === "lost") say(texts.said.lost(robot));
            else if (now === "fault") say(texts.said.fault(robot, message.reason));
            else if (then === "lost") say(texts.said.found(robot));
        } else if (type === "link" && lab.store.link.ever) {
            say(message.up ? texts.said.labFound : texts.said.labLost);
        }
    });
}
