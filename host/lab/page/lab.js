/** The lab as the panels see it: what is known, and how to ask for something. */

import { absentTexts } from "./absent_texts.js";
import { besideTexts } from "./beside_texts.js";
import { Store } from "./store.js";
import { texts } from "./texts.js";
import { sentences } from "./words.js";

export class Lab {
    #waiting = new Map();
    #number = 0;
    #told = null;

    /** @param {{send: (message: object) => boolean, onmessage: Function}} source */
    constructor(source) {
        this.source = source;
        this.store = new Store();
        /** Whether something has changed since the panels were last updated. */
        this.changed = true;
        /** Whether records have come since then. */
        this.fresh = false;
        /** @type {((message: object) => void)[]} Hear each message after the store. */
        this.listeners = [];
        source.onmessage = (message) => this.#take(message);
    }

    /**
     * Send a message that nobody answers.
     * @param {object} message
     * @returns {boolean} Whether it has left.
     */
    send(message) {
        return this.source.send(message);
    }

    /**
     * Send a message and wait for its reply.
     * @param {object} message Without its `request`.
     * @returns {Promise<object>} The result. It fails with `{message, hint}`.
     */
    request(message) {
        this.#number += 1;
        const request = this.#number;
        return new Promise((resolve, reject) => {
            if (this.send({ ...message, request })) this.#waiting.set(request, { resolve, reject });
            else reject(texts.notConnected);
        });
    }

    /**
     * Have a robot do something.
     * @param {string} command As MESSAGES.md says.
     * @param {object} given Its arguments.
     * @param {string} [robot] Its name; that of the selected one if it is left out.
     * @returns {Promise<object>} The result. It fails with `{message, hint}`.
     */
    do(command, given = {}, robot = this.store.robot?.name) {
        return this.request({ type: "do", robot, command, arguments: given });
    }

    /**
     * The same, where only a refusal has to be said: the robot's state shows that it worked, and
     * then what was said of an earlier one is over.
     * @returns {Promise<object | null>} The result, null if it was refused.
     */
    async try(command, given = {}) {
        const [result] = await this.tryEach([this.store.robot ?? {}], command, given);
        return result;
    }

    /**
     * The same of several robots at once. If some refuse, their names are said, and the others do
     * it all the same.
     * @param {import("./robot_view.js").RobotView[]} robots
     * @returns {Promise<(object | null)[]>} The result of each.
     */
    async tryEach(robots, command, given = {}) {
        const refusals = [];
        const ask = (robot) =>
            this.do(command, given, robot.name).catch(({ message, hint }) => {
                const { name, status } = robot;
                refusals.push({ robot: name, message, hint: onPage(hint, command, status) });
                return null;
            });
        const results = await Promise.all(robots.map(ask));
        if (refusals.length) this.tell(noteOf(refusals, this.store.robots.length > 1));
        else if (this.store.note === this.#told) this.tell(null);
        return results;
    }

    /** @param {{message: string, hint: string}} note What a person should know. */
    tell(note) {
        this.store.note = this.#told = note;
        this.changed = true;
    }

    #take(message) {
        this.store.take(message);
        if (message.type === "reply") this.#settle(message);
        if (message.type === "link" && !message.up) this.#abandon();
        if (message.type === "records") this.fresh = true;
        else this.changed = true;
        for (const listener of this.listeners) listener(message);
    }

    #settle({ request, result, error }) {
        const waiting = this.#waiting.get(request);
        this.#waiting.delete(request);
        if (error) waiting?.reject(error);
        else waiting?.resolve(result);
    }

    #abandon() {
        for (const { reject } of this.#waiting.values()) reject(texts.answerLost);
        this.#waiting.clear();
    }
}

/** What to do next, as it is done on the page if a terminal's command was named. */
function onPage(hint, command, { remedy, controller } = {}) {
    if (hint?.includes("--take-over")) return absentTexts.drivenElsewhere(controller);
    // Who has just pressed the remedy's button has to read why that did not help.
    const helps = command !== remedy && /kickctl (start|clear)\b/.test(hint);
    return (helps && absentTexts.press[remedy]) || hint;
}

/** What several robots have refused, a line for each. */
function noteOf(refusals, named) {
    const lines = refusals.map(({ robot, message, hint }) => {
        const words = sentences(message, hint);
        return named ? besideTexts.named(robot, words) : words;
    });
    return { message: lines.join("\n"), hint: "", robots: refusals.map(({ robot }) => robot) };
}
