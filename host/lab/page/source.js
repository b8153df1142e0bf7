/**
 * The connection to the lab's server. A source is an object with `send(message)` and
 * `onmessage(message)`; another one, a file or a worker, can take its place. This one adds
 * messages of its own: `{type: "link", up, again_s}` when the connection breaks or comes back.
 * Records come as `{type: "records", data: ArrayBuffer}`.
 */

import { keepPage, keyInAddress, readKey, readPage } from "./keys.js";

const FIRST_PAUSE_MS = 250;
const LONGEST_PAUSE_MS = 5000;
// The server says something once a second; a connection that is silent for longer is dead.
const SILENCE_MS = 3500;

/** @returns {string} Where the lab that has served this page listens. */
export function messagesAddress() {
    const address = new URL("messages", location.href);
    address.protocol = address.protocol.replace("http", "ws");
    address.hash = "";
    return address.href;
}

export class WebSocketSource {
    #socket = null;
    #pause = FIRST_PAUSE_MS;
    #heard = 0;
    #welcome = false;
    #key = "";
    #timer = 0;

    /** @param {string} url Where the lab listens, `ws://...`. */
    constructor(url) {
        this.url = url;
        /** @type {(message: object) => void} */
        this.onmessage = () => {};
        setInterval(() => this.#listen(), 500);
        addEventListener("online", () => this.#hurry());
        addEventListener("pageshow", () => this.#hurry());
        // Another address of the same lab, typed into this tab, loads no page anew.
        addEventListener("hashchange", () => this.#change());
    }

    /** Connect now, instead of any connection that there is. */
    open() {
        clearTimeout(this.#timer);
        this.#drop();
        this.#heard = performance.now();
        this.#key = readKey();
        const socket = new WebSocket(this.url);
        socket.binaryType = "arraybuffer";
        socket.onopen = () => this.#say({ type: "join", key: this.#key, resume: readPage() });
        socket.onmessage = (event) => this.#take(event.data);
        socket.onclose = () => this.#lose();
        this.#socket = socket;
    }

    /**
     * Send a message.
     * @param {object} message As MESSAGES.md says.
     * @returns {boolean} Whether it has left: the lab has let this page in.
     */
    send(message) {
        return this.#welcome && this.#say(message);
    }

    #say(message) {
        if (this.#socket?.readyState !== WebSocket.OPEN) return false;
        this.#socket.send(JSON.stringify(message));
        return true;
    }

    #take(data) {
        this.#heard = performance.now();
        if (typeof data !== "string") {
            this.onmessage({ type: "records", data });
            return;
        }
        const message = JSON.parse(data);
        if (message.type === "welcome") {
            this.#welcome = true;
            this.#pause = FIRST_PAUSE_MS;
            keepPage(message.page);
            this.onmessage({ type: "link", up: true, again_s: 0 });
        } else if (message.type === "refused") {
            this.#drop();
        }
        this.onmessage(message);
    }

    #drop() {
        this.#welcome = false;
        if (!this.#socket) return;
        this.#socket.onclose = this.#socket.onmessage = this.#socket.onopen = null;
        this.#socket.close();
        this.#socket = null;
    }

    #lose() {
        this.#drop();
        this.#timer = setTimeout(() => this.open(), this.#pause);
        this.onmessage({ type: "link", up: false, again_s: this.#pause / 1000 });
        this.#pause = Math.min(LONGEST_PAUSE_MS, this.#pause * 2);
    }

    #listen() {
        if (this.#socket && performance.now() - this.#heard > SILENCE_MS) this.#lose();
    }

    // A link within the page changes the address, too, but not its key.
    #change() {
        const key = keyInAddress();
        if (!key || (this.#welcome && key === this.#key)) return;
        // Who waits for an answer waits no more: it would come to the connection that ends here.
        if (this.#welcome) this.onmessage({ type: "link", up: false, again_s: 0 });
        this.open();
    }

    #hurry() {
        if (!this.#welcome && this.#timer) this.open();
    }
}
