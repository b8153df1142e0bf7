/**
 * STOP: the button, Esc and Space. It asks nothing, stops all robots, and says in words what each
 * of them has confirmed.
 */

import { byId, setText } from "./dom.js";
import { AT_REST } from "./robot_view.js";
import { texts } from "./texts.js";

const PATIENCE_MS = 1500;

export class Stop {
    #asked = new Map();
    #owed = false;
    #byKeyboard = false;
    #pointed = true;

    /** @param {import("./lab.js").Lab} lab */
    constructor(lab) {
        this.lab = lab;
        this.button = byId("stop");
        this.words = byId("stop-words");
        // A pointer stops when it goes down, not when it comes up.
        this.button.onpointerdown = () => this.press();
        this.button.onclick = (event) => event.detail === 0 && this.press();
        lab.listeners.push((message) => this.#hear(message));
        addEventListener("keydown", (event) => this.#key(event), true);
        addEventListener("pointerdown", () => this.#point(), true);
        addEventListener("focusin", () => (this.#byKeyboard = !this.#pointed), true);
        addEventListener("click", (event) => this.#release(event));
    }

    /** Stop all robots, at once. */
    press() {
        const sent = this.lab.send({ type: "stop", robot: null });
        this.#owed = !sent;
        for (const robot of this.lab.store.robots) {
            this.#asked.set(robot.name, { heard: robot.heard, at: performance.now() });
        }
        setTimeout(() => (this.lab.changed = true), PATIENCE_MS + 10);
        this.lab.changed = true;
    }

    /**
     * What is known about the last stop.
     * @returns {Object<string, "sent" | "confirmed" | "unconfirmed" | "waiting">} By robot.
     */
    progress() {
        const { robots } = this.lab.store;
        const asked = robots.filter(({ name }) => this.#asked.has(name));
        return Object.fromEntries(asked.map((robot) => [robot.name, this.#progressOf(robot)]));
    }

    /** Say what is known. */
    update() {
        const progress = Object.entries(this.progress());
        const several = progress.length > 1;
        const same = new Set(progress.map(([, stage]) => stage)).size === 1;
        const lines = progress.map(([name, stage]) =>
            several && !same ? `${name}: ${texts.stop[stage]}` : texts.stop[stage],
        );
        if (this.#owed && !lines.length) lines.push(texts.stop.waiting);
        setText(this.words, [...new Set(lines)].join(" "));
        const worst = progress.some(([, stage]) => stage !== "confirmed" && stage !== "sent");
        this.words.classList.toggle("alarm", worst);
    }

    #progressOf(robot) {
        const asked = this.#asked.get(robot.name);
        if (this.#owed) return "waiting";
        if (robot.heard > asked.heard && AT_REST.includes(robot.state) && !robot.lost) {
            asked.confirmed = true;
        }
        if (asked.confirmed) return "confirmed";
        return performance.now() - asked.at > PATIENCE_MS ? "unconfirmed" : "sent";
    }

    #hear(message) {
        if (message.type === "welcome") {
            // The counts of what is heard of the robots start at zero again.
            for (const asked of this.#asked.values()) asked.heard = 0;
            if (this.#owed) this.press();
        }
        // What was said about a stop is over as soon as somebody starts the robot again.
        if (message.type === "event" && ["start", "resume"].includes(message.event.event)) {
            this.#asked.delete(message.robot);
        }
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
