/** A guided exercise as it goes on: the prediction, the logs of what was done, and the check. */

import { keep, recall } from "./storage.js";

const KEPT = "lab.exercises";
const FRESH = {
    guess: null,
    locked: false,
    logs: [],
    runs: [],
    own: null,
    hints: 0,
    findings: [],
    done: false,
};

/** What this browser remembers of exercises: a reload or a closed tab changes nothing. */
export class Lesson {
    // Of which run of the lab it is; logs and runs of others are not known to this one.
    #run = "";
    // What was asked for last, and how much of it is not done yet.
    #last = Promise.resolve();
    #waiting = 0;

    /** @param {import("./lab.js").Lab} lab */
    constructor(lab) {
        this.lab = lab;
        /** @type {object[]} The texts of all exercises, once the lab has told them. */
        this.all = [];
        /** @type {?{name: string, guess: ?number, locked: boolean, logs: string[], runs: object[],
         *     own: ?number, hints: number, findings: object[], done: boolean}} The exercise that
         *     goes on; runs: those of its model wheel, own: the pupil's own number. */
        this.state = null;
        /** @type {string[]} The names of the exercises that are done. */
        this.done = [];
        /** @type {object} Exercises that were left after the prediction was locked, by name. */
        this.left = {};
        this.checking = false;
        /** Whether the last thing went wrong; then the next one is a person's. */
        this.stuck = false;
        // Another tab of this browser has gone on.
        addEventListener("storage", ({ key }) => key === KEPT && this.#recall());
    }

    /**
     * Know what was done in this run of the lab, once the lab has said which one it is.
     * @returns {boolean} Whether an exercise goes on that was not known before.
     */
    meet() {
        const { welcome, role, canDrive } = this.lab.store;
        if (!welcome || welcome.lab === this.#run || (role !== "drive" && !canDrive)) return false;
        this.#run = welcome.lab;
        this.#recall();
        return this.state !== null;
    }

    #recall() {
        const kept = JSON.parse(recall("localStorage", KEPT) ?? "null");
        const { state = null, done = [], left = {} } = kept?.run === this.#run ? kept : {};
        Object.assign(this, { state, done, left });
        this.#show();
    }

    /** @returns {?object} The texts of the exercise that goes on. */
    get texts() {
        return this.all.find(({ name }) => name === this.state?.name) ?? null;
    }

    /** @returns {boolean} Whether something is being done. */
    get busy() {
        return this.#waiting > 0;
    }

    /** Get the texts. */
    async load() {
        if (this.all.length || this.busy || !this.lab.store.link.up) return;
        await this.#alone(async () => {
            this.all = (await this.lab.request({ type: "lessons" })).lessons;
        });
    }

    /**
     * Begin an exercise: the robot stands still until the prediction is locked. One that was left
     * goes on with its prediction.
     */
    choose(name) {
        this.lab.send({ type: "stop", robot: this.lab.store.robot.name });
        this.lab.tell(null); // what was said of another exercise
        this.state = this.left[name] ?? { name, ...structuredClone(FRESH) };
        delete this.left[name];
        this.#changed();
        const { texts } = this;
        if (this.state.locked) this.#alone(() => this.#prepare(texts));
    }

    guess(answer) {
        this.state.guess = answer;
        this.#changed();
    }

    /** From here on the prediction holds, and the robot may move. */
    lock() {
        const { state, texts } = this;
        return this.#alone(async () => {
            await this.#prepare(texts);
            state.locked = true;
        });
    }

    /** Have a log recorded as long as the exercise goes on, also after a reload. */
    follow() {
        const { canDrive, robot } = this.lab.store;
        if (!this.state?.locked || this.state.done || this.busy || this.stuck || !canDrive) return;
        if (!this.texts || this.texts.model) return;
        if (!robot.status.recording) this.#alone(() => this.lab.do("record", { on: true }));
    }

    hint() {
        this.state.hints += 1;
        this.#changed();
    }

    /**
     * Let the model wheel of the exercise go.
     * @param {number} value What the pupil has chosen.
     * @param {(run: object) => void} take Gets the run, as MESSAGES.md says.
     */
    run(value, take) {
        const { state } = this;
        return this.#alone(async () => {
            const run = await this.lab.request({ type: "model", lesson: state.name, value });
            state.runs.push({ value, seen: run.seen });
            take(run);
        });
    }

    /** @param {?number} own The pupil's own number; null for none. */
    answer(own) {
        this.state.own = own;
        this.#changed();
    }

    /** Have the lab check what was done since the prediction. */
    check() {
        this.checking = true;
        const { state, texts } = this;
        const { name, logs, runs, own } = state;
        return this.#alone(async () => {
            const what = texts.model ? { runs, own } : { logs };
            if (!texts.model) {
                this.#noteLog(state);
                this.#changed();
                await this.lab.do("record", { on: false });
            }
            const found = await this.lab.request({ type: "check", lesson: name, ...what });
            Object.assign(state, found);
            if (!found.done) return;
            this.done = [...new Set([...this.done, name])];
        });
    }

    /** Go back to the list, done or not. A locked prediction stays. */
    leave() {
        const { name, locked, done } = this.state;
        const goesOn = locked && !done;
        const records = goesOn && !this.texts.model;
        if (goesOn) {
            if (records) this.#noteLog(this.state);
            this.left[name] = this.state;
        }
        this.state = null;
        this.lab.tell(null);
        this.#changed();
        if (records) this.#alone(() => this.lab.do("record", { on: false }));
    }

    /** Set the robot as the exercise needs it, and end a recording of something else. */
    async #prepare(texts) {
        if (texts.model) return;
        if (this.lab.store.robot.status.recording) await this.lab.do("record", { on: false });
        await this.lab.do("set", { set: texts.set });
    }

    /** The log that is being recorded belongs to the exercise. */
    #noteLog({ logs }) {
        const { recording } = this.lab.store.robot.status;
        if (recording && !logs.includes(recording)) logs.push(recording);
    }

    /** Do one thing after the other, and say what went wrong. */
    #alone(work) {
        this.#waiting += 1;
        this.lab.changed = true;
        this.#last = this.#last.then(async () => {
            this.stuck = false;
            try {
                await work();
            } catch (error) {
                this.stuck = true;
                this.lab.tell(error.message ? error : { message: String(error), hint: "" });
            }
            this.#waiting -= 1;
            this.checking = false;
            this.#changed();
        });
        return this.#last;
    }

    #changed() {
        const { state, done, left } = this;
        keep("localStorage", KEPT, JSON.stringify({ run: this.#run, state, done, left }));
        this.#show();
    }

    /** Let the page know what the exercise allows. */
    #show() {
        this.lab.store.held = Boolean(this.state && !this.state.locked);
        const goesOn = this.state?.locked && !this.state.done;
        this.lab.store.still = Boolean(goesOn && this.texts?.still);
        this.lab.store.straight = Boolean(goesOn && this.texts?.walls);
        this.lab.changed = true;
    }
}
