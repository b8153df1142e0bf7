/** A robot in a notebook: its drawings as it moves, and a button that stops it. */

import { element, setText } from "./dom.js";
import { addDrawings, labelWheels } from "./drawings.js";
import { Frames } from "./frames.js";
import { Board, Onlookers, part } from "./notebook.js";
import { words } from "./notebook_texts.js";
import { Pace } from "./pace.js";
import { RobotView, STATES } from "./robot_view.js";
import { Views } from "./views.js";

// How long a stop may take until it counts as not confirmed, ms.
const PATIENCE_MS = 1500;
// How often the kernel hears that somebody looks, ms. It waits for a minute.
const HERE_MS = 20000;
const LABEL_MS = 250;
const [FIRST_PAUSE_MS, LONGEST_PAUSE_MS] = [200, 5000];

/** What the kernel has said of the robot; all views of the widget show the same. */
class Known {
    /** @type {?RobotView} */
    robot = null;
    embedded = false;
    stop = { asked: NaN, said: "" };

    take(message, buffers) {
        this[`_${message.type}`](message, buffers);
    }

    _welcome({ robot, embedded }) {
        this.robot = new RobotView(robot);
        this.embedded = embedded;
        if (embedded) this.robot.playout = new Pace(this.robot.ring);
    }

    _records(_, [{ buffer, byteOffset, byteLength }]) {
        const data = buffer.slice(byteOffset, byteOffset + byteLength);
        this.robot.takeRecords(data, performance.now() / 1000);
    }

    _state(message) {
        this.robot.takeState(message);
    }

    _event({ event }) {
        this.robot.takeEvent(event);
        // What was said about a stop is over as soon as somebody starts the robot again.
        if (["start", "resume"].includes(event.event)) this.stop = { asked: NaN, said: "" };
    }

    _outcome(message) {
        this.robot.takeVerdict(message);
    }

    _stopped({ said }) {
        this.stop = { asked: NaN, said: words.stopped(said), done: true };
    }

    _unconfirmed(error) {
        this.stop = { asked: NaN, said: words.failed(error) };
    }

    /** @returns {string} What is known about the last stop, for people. */
    stopWords() {
        const { asked, said } = this.stop;
        if (Number.isNaN(asked)) return said;
        return performance.now() - asked > PATIENCE_MS ? words.unconfirmed : words.stop.sent;
    }
}

export default () => {
    const known = new Known();
    let onlookers = null;

    return {
        initialize({ model }) {
            onlookers = new Onlookers(model);
            const take = (message, buffers) => known.take(message, buffers);
            model.on("msg:custom", take);
            let timer = 0;
            // What is sent before the notebook has a subshell waits for the cell that runs.
            const join = (pause) => {
                if (known.robot) return;
                model.send({ type: "join" });
                timer = setTimeout(() => join(Math.min(2 * pause, LONGEST_PAUSE_MS)), pause);
            };
            join(FIRST_PAUSE_MS);
            return () => {
                clearTimeout(timer);
                model.off("msg:custom", take);
            };
        },

        render({ model, el }) {
            const view = new View(model, el, known);
            onlookers.come();
            return () => {
                view.frames.stop();
                onlookers.go();
            };
        },
    };
};

class View {
    #views = null;
    #told = performance.now();
    #labelled = 0;

    constructor(model, el, known) {
        this.model = model;
        this.known = known;
        this.state = element("b", { className: "state" });
        this.name = element("span");
        this.reason = element("span", { className: "reason" });
        this.words = element("span", { className: "stop-words", role: "status" });
        const stop = part("button", "stop", { type: "button", className: "stop" });
        stop.textContent = words.stopButton;
        // A pointer stops when it goes down, not when it comes up.
        stop.onpointerdown = () => this.#stop();
        stop.onclick = (event) => event.detail === 0 && this.#stop();
        const said = [this.state, this.name, this.reason, this.words];
        const facts = element("div", { className: "facts" }, ...said);
        this.board = new Board(el, [element("div", { className: "top" }, facts, stop)], []);
        this.board.keepKeys();
        this.board.root.onkeydown = (event) => this.#key(event);
        this.frames = new Frames(
            () => this.#update(),
            () => this.#beat(),
        );
        addDrawings(this.frames, this.board, () => this.#views, this.board.find);
        // For tests, and for people at the console.
        this.board.root.kickctl = () => this.#snapshot();
    }

    #stop() {
        this.model.send({ type: "stop" });
        this.known.stop = { asked: performance.now(), said: "" };
    }

    #key(event) {
        if (event.key !== "Escape") return;
        event.preventDefault();
        event.stopPropagation();
        if (!event.repeat) this.#stop();
    }

    // The browser calls no frames of what is hidden: then the kernel soon says nothing more.
    #beat() {
        if (performance.now() - this.#told < HERE_MS) return;
        this.#told = performance.now();
        this.model.send({ type: "here" });
    }

    /** @returns {boolean} Whether there is something new to draw. */
    #update() {
        const { robot } = this.known;
        const { theme } = this.board; // which also sets the colours of the words
        setText(this.words, this.known.stopWords());
        this.words.style.color = Number.isNaN(this.known.stop.asked) ? "" : theme.colours.kick;
        if (!robot) return false;
        if (this.#views?.robot !== robot) {
            this.#views = new Views(robot);
            this.#views.linked = true;
            this.board.find("stop").setAttribute("aria-label", words.stopLabel(robot.name));
            setText(this.name, robot.name);
        }
        const now = performance.now();
        const moved = this.#views.update(now / 1000);
        const state = robot.lost ? "lost" : this.#stateShown();
        this.state.dataset.state = state;
        setText(this.state, words.states[state]);
        setText(this.reason, this.#why(state, robot.status));
        if (now - this.#labelled < LABEL_MS) return moved;
        this.#labelled = now;
        labelWheels(this.#views, this.board.find);
        return true;
    }

    /** Why it is so, or what to know of it. */
    #why(shown, { state, reason, closed }) {
        const { robot, embedded } = this.known;
        if (robot.lost) return words.lost(robot.lostFor(), closed);
        if (!robot.ring.length) return embedded ? words.embeddedWaits : words.waiting;
        // Of a stop from here all is said; the reason would name its own user as a stranger.
        if (state === "stopped" && this.known.stop.done) return embedded ? words.embedded : "";
        if (reason && state === shown && state !== "running") return words.reason(reason);
        return embedded ? words.embedded : "";
    }

    #stateShown() {
        const { ring } = this.known.robot;
        return ring.length ? STATES[ring.columns.state[ring.place(this.#views.age)]] : "";
    }

    #snapshot() {
        const { robot } = this.known;
        return {
            record: robot?.ring.record() ?? null,
            records: robot?.ring.length ?? 0,
            missed: robot?.missed ?? 0,
            lost: robot?.lost ?? null,
            shown_s: this.#views?.time ?? null,
            state: this.state.dataset.state ?? "",
            wheels: structuredClone(this.#views?.wheels ?? null),
            stop: this.words.textContent,
            frames: this.frames.count,
            p95_ms: this.frames.p95(),
        };
    }
}
