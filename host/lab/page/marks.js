/** What happened in a log, and in which tick: for the marks on the slider and for the list. */

import { words } from "./replay_texts.js";

const DIFFERENT = 3;
// A log that differs everywhere needs no thousand lines to say so.
const MOST_DIFFERENCES = 50;

/**
 * @typedef {Object} Mark
 * @property {number} place the number of the record
 * @property {number} ticks how many it lasts, at least 1
 * @property {"kick" | "fault" | "stop" | "start" | "missing" | "differs" | "other"} kind
 * @property {string} words for people
 */

/**
 * @param {object} tape
 * @param {import("./ring.js").Ring} ring The tape's records; the first is in place 0.
 * @returns {Mark[]} In the order in which they happened.
 */
export function marksOf(tape, ring) {
    const { tick, missed, compared } = ring.columns;
    const last = tape.ticks - 1;
    const marks = [];
    const add = (place, kind, said, ticks = 1) =>
        marks.push({ place: Math.min(place, last), kind, words: said, ticks });

    for (const { place, event } of tape.events) {
        if (event.event === "snapshot") continue;
        // The gap itself says how many are missing.
        if (event.event === "lost" && tape.gaps.some((gap) => gap.place === place)) continue;
        const said = (words.events[event.event] ?? words.otherEvent)(event);
        if (event.event !== "kick") {
            add(place, KINDS[event.event] ?? "other", said);
            continue;
        }
        const { begin, ticks } = event.kick;
        let first = place;
        while (first < last && tick[first] < begin) first += 1;
        const twin = tape.twin?.kicks.find((one) => one.place === place);
        add(first, "kick", twin ? words.beside(said, twin) : said, ticks);
    }
    for (const { place, ticks } of tape.gaps) add(place, "missing", words.missing(ticks));
    let differences = 0;
    for (let place = 0; place <= last; place += 1) {
        if (missed[place]) add(place, "missing", words.missed(missed[place]));
        const begins = compared[place] === DIFFERENT && compared[place - 1] !== DIFFERENT;
        if (begins && differences < MOST_DIFFERENCES) {
            differences += 1;
            add(place, "differs", words.differs);
        }
    }
    return marks.sort((one, other) => one.place - other.place);
}

const KINDS = {
    fault: "fault",
    stop: "stop",
    hold: "stop",
    start: "start",
    resume: "start",
    restart: "missing",
    lost: "missing",
};
