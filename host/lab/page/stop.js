/**
 * STOP: the buttons, Esc and Space. It asks nothing, stops all robots or the one whose button it
 * is, and says in words what each of them has confirmed.
 */

import { absentTexts } from "./absent_texts.js";
import { byId, setText } from "./dom.js";
import { AT_REST } from "./robot_view.js";
import { texts } from "./texts.js";

const PATIENCE_MS = 1500;

export class Stop {
    #asked = new Map();
    // Names of robots whose STOP waits for the link; null for all of them.
    #owed = new Set();
    // Whether one was pressed that never leaves, because the lab does not let this page in.
    #vain = false;
    #byKeyboard = false;
    #pointed = true;

    /** @param {import("./lab.js").Lab} lab */
    constructor(lab) {
        this.lab = lab;
        this.line = byId("stop-words");
        this.obey(byId("stop"));
        lab.listeners.push((message) => this.#hear(message));
        addEventListener("keydown", (event) => this.#key(event), true);
        addEventListener("pointerdown", () => this.#point(), true);
        addEventListener("focusin", () => (this.#byKeyboard = !this.#pointed), true);
        addEventListener("click", (event) => this.#release(event));
    }

    /**
     * Stop by a button.
     * @param {HTMLButtonElement} button
     * @param {() => ?string} name Of the robot that it stops; null for all.
     */
    obey(button, name = () => null) {
        // A pointer stops when it goes down, not when it comes up.
        button.onpointerdown = () => this.press(name());
        button.onclick = (event) => event.detail === 0 && this.press(name());
    }

    /**
     * Stop at once.
     * @param {?string} name The robot; null for all.
     */
    press(name = null) {
        const sent = this.lab.send({ type: "stop", robot: name });
        // Who is let in later must not stop what somebody else has begun since.
        const vain = !sent && Boolean(this.lab.store.refused);
        if (vain) this.#vain = true;
        else if (sent) this.#owed.delete(name);
        else this.#owed.add(name);
        for (const robot of this.lab.store.robots) {
            if (name !== null && robot.name !== name) continue;
            this.#asked.set(robot.name, { heard: robot.heard, at: performance.now(), vain });
        }
        setTimeout(() => (this.lab.changed = true), PATIENCE_MS + 10);
        this.lab.changed = true;
    }

    /**
     * What is known about the last stop.
     * @returns {Object<string, "sent" | "confirmed" | "unconfirmed" | "waiting" | "refused">} By
     *     robot.
     */
    progress() {
        const { robots } = this.lab.store;
        const asked = robots.filter(({ name }) => this.#asked.has(name));
        return Object.fromEntries(asked.map((robot) => [robot.name, this.#progressOf(robot)]));
    }

    /** Say what is known. */
    update() {
        const progress = Object.entries(this.progress());
        const words = progress.map(([name, stage]) => this.words(name, stage));
        const all = words.length === this.lab.store.robots.length;
        const same = all && new Set(words).size === 1;
        const lines = progress.map(([name, stage], at) =>
            same || stage === "refused" ? words[at] : `${name}: ${words[at]}`,
        );
        if (!lines.length && this.#vain) lines.push(this.words(null, "refused"));
        else if (!lines.length && this.#owed.size) lines.push(texts.stop.waiting);
        setText(this.line, [...new Set(lines)].join(" "));
        const worst = progress.some(([, stage]) => stage !== "confirmed" && stage !== "sent");
        this.line.classList.toggle("alarm", worst || this.#vain);
    }

    /**
     * What is known of a stop, in words.
     * @param {?string} name The robot.
     * @param {string} stage As `progress` says.
     * @returns {string}
     */
    words(name, stage) {
        if (stage === "refused") return absentTexts.cannotStop(this.lab.store.refused);
        // What a robot has confirmed may be over by the time that it is lost.
        const robot = this.lab.store.byName(name);
        const past = stage === "confirmed" && robot.lost;
        return past ? absentTexts.hadStopped(robot.lostFor()) : texts.stop[stage];
    }

    #progressOf(robot) {
        const asked = this.#asked.get(robot.name);
        if (asked.vain) return "refused";
        if (this.#owed.has(robot.name) || this.#owed.has(null)) return "waiting";
        if (robot.heard > asked.heard && AT_REST.includes(robot.state) && !robot.lost) {
            asked.confirmed = true;
        }
        if (asked.confirmed) return "confirmed";
        return performance.now() - asked.at > PATIENCE_MS ? "unconfirmed" : "sent";
    }

    #hear(message) {
        if (message.type === "refused") {
            this.#giveUp();
        } else if (message.type === "welcome") {
            this.#vain = false;
            for (const [name, { vain }] of this.#asked) if (vain) this.#asked.delete(name);
            // The counts of what is heard of the robots start at zero again.
            for (const asked of this.#asked.values()) asked.heard = 0;
            for (const name of this.#owed) this.press(name);
        }
        // What was said about a stop is over as soon as somebody starts the robot again.
        if (message.type === "event" && ["start", "resume"].includes(message.event.event)) {
            this.#asked.delete(message.robot);
        }
    }

    // What waits for the link does not leave any more.
    #giveUp() {
        if (this.#owed.size) this.#vain = true;
        for (const [name, asked] of this.#asked) {
            asked.vain ||= this.#owed.has(name) || this.#owed.has(null);
        }
        this.#owed.clear();
    }

    #key(event) {
        if (event.key === "Tab" || event.key.startsWith("Arrow")) {
            this.#pointed = false;
            return;
        }
        const control = document.activeElement?.closest("button, input, summary, a, [tabindex]");
        const space = event.key === " " && !(control && this.#byKeyboard);
        if (event.key !== "Escape" && !space) return;
        event.preventDefault();
        event.stopPropagation();
        if (!event.repeat) this.press();
    }

    #point() {
        this.#pointed = true;
        this.#byKeyboard = false;
    }

    // A click leaves the focus on no button, so that Space cannot press it again.
    #release(event) {
        const pressed = event.target.closest?.("button, summary");
        if (pressed && event.detail > 0) document.activeElement?.blur();
    }
}
