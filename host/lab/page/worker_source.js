/**
 * The lab without a server: a worker runs the robot's own Python. A source as in source.js.
 */

import { aloneTexts } from "./alone_texts.js";

const SEEDS = 2 ** 32;

export class WorkerSource {
    #worker = null;
    #welcome = false;

    /** @param {?string} seed The seed in the page's address; null for one by chance. */
    constructor(seed) {
        const whole = seed !== null && /^\d+$/.test(seed) && Number(seed) < SEEDS;
        /** What a person should know, null for nothing. */
        this.note = seed === null || whole ? null : aloneTexts.noSeed(seed);
        // As a name: a worker that comes out of the cache does not know its address.
        this.name = whole ? seed : "";
        /** What a person waits for before the first message. */
        this.waiting = aloneTexts.loading;
        /** @type {(message: object) => void} */
        this.onmessage = () => {};
    }

    /** Start the robot, instead of any that there is. */
    open() {
        this.#worker?.terminate();
        this.#welcome = false;
        this.#worker = new Worker("robot_worker.js", { type: "module", name: this.name });
        this.#worker.onmessage = ({ data }) => this.#take(data);
        this.#worker.onerror = ({ message }) => this.#fail(message);
        // Where pages may not keep files, this one needs the network again.
        navigator.serviceWorker?.register("offline.js").catch(() => {});
    }

    /**
     * Send a message.
     * @param {object} message As MESSAGES.md says.
     * @returns {boolean} Whether it has left: the robot runs.
     */
    send(message) {
        if (this.#welcome) this.#worker.postMessage(JSON.stringify(message));
        return this.#welcome;
    }

    #take(data) {
        if (typeof data !== "string") {
            this.onmessage({ type: "records", data });
            return;
        }
        const message = JSON.parse(data);
        if (message.type === "failed") {
            this.#fail(message.why);
            return;
        }
        if (!this.#welcome && message.type === "welcome") {
            this.#welcome = true;
            this.onmessage({ type: "link", up: true, again_s: 0 });
        }
        this.onmessage(message);
    }

    #fail(why) {
        this.#welcome = false;
        this.onmessage({ type: "link", up: false, again_s: 0 });
        this.onmessage({ type: "refused", ...aloneTexts.failed(why) });
    }
}
