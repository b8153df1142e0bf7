/**
 * The lab without a server: a worker runs the robot's own Python. A source as in source.js.
 */

import { aloneTexts } from "./alone_texts.js";

export class WorkerSource {
    #worker = null;
    #welcome = false;

    /** @param {string} url The worker's script. */
    constructor(url) {
        this.url = url;
        /** What a person waits for before the first message. */
        this.waiting = aloneTexts.loading;
        /** @type {(message: object) => void} */
        this.onmessage = () => {};
    }

    /** Start the robot, instead of any that there is. */
    open() {
        this.#worker?.terminate();
        this.#welcome = false;
        this.#worker = new Worker(this.url, { type: "module" });
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
