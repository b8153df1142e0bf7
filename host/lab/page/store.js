/** What the page knows, from the messages of the lab. Nothing here draws or sends. */

import { RobotView } from "./robot_view.js";
import { TwinView } from "./twin_view.js";
import { sentences } from "./words.js";

export class Store {
    constructor() {
        this.link = { up: false, again_s: 0, since: performance.now(), ever: false };
        this.refused = null;
        this.page = null;
        this.role = "";
        this.welcome = null;
        /** @type {RobotView[]} */
        this.robots = [];
        /** @type {TwinView[]} */
        this.twins = [];
        this.selected = 0;
        /** Whether kicks go to all robots. */
        this.all = false;
        /** Whether this page shows basins: those of the chosen robot, which the lab computes. */
        this.basins = true;
        this.baton = { driver: null, you: false, asking: [], why: "" };
        this.pages = { driving: 0, watching: 0 };
        this.score = { guesses: 0, right: 0, predicted: 0, simulation: 0 };
        this.note = null;
        /** Whether an exercise waits for a prediction, before which nothing moves. */
        this.held = false;
        /** Whether an exercise goes on in which the motors stay off. */
        this.still = false;
        /** Whether an exercise goes on that needs a robot that drives straight. */
        this.straight = false;
        /** The newest `poll` message. */
        this.poll = { state: "none", score: { kicks: 0 } };
    }

    /** @returns {RobotView | undefined} The robot that this page drives, and may show large. */
    get robot() {
        return this.robots[this.selected];
    }

    /** @returns {RobotView[]} The robots to which a kick goes. */
    get targets() {
        return this.all ? this.robots : this.robots.filter((robot) => robot === this.robot);
    }

    /** @returns {boolean} Whether this page could command; its first command takes the baton. */
    get canDrive() {
        const free = this.role === "drive" && this.baton.driver === null;
        return this.link.up && (this.baton.you || free);
    }

    /** @returns {boolean} Whether this page may command now. */
    get mayDrive() {
        return this.canDrive && !this.held;
    }

    /** @param {string} name @returns {RobotView | undefined} */
    byName(name) {
        return this.robots.find((robot) => robot.name === name);
    }

    /** @param {string} name Of a robot. @returns {TwinView | undefined} Its twin. */
    twinOf(name) {
        return this.twins.find(({ robot }) => robot.name === name);
    }

    /**
     * Take a message.
     * @param {object} message As MESSAGES.md says, or one of the source's own.
     */
    take(message) {
        this[`_${message.type}`]?.(message);
    }

    _link({ up, again_s }) {
        const since = up === this.link.up ? this.link.since : performance.now();
        this.link = { up, again_s, since, ever: this.link.ever || up };
        if (up) this.refused = null;
    }

    _welcome(message) {
        const shown = this.robot?.name;
        this.welcome = message;
        this.page = message.page;
        this.role = message.role;
        this.robots = message.robots.map((info) => new RobotView(info));
        this.twins = (message.twins ?? []).map(
            (info) => new TwinView(info, this.byName(info.robot)),
        );
        this.selected = Math.max(
            0,
            this.robots.findIndex(({ name }) => name === shown),
        );
    }

    _refused(message) {
        this.refused = message;
        this.link = { ...this.link, up: false };
    }

    _records({ data }) {
        const index = new DataView(data).getUint8(1);
        const view = this.robots[index] ?? this.twins[index - this.robots.length];
        view?.takeRecords(data, performance.now() / 1000);
    }

    _state(message) {
        const robot = this.byName(message.robot);
        const back = robot?.lost && message.link === "up";
        robot?.takeState(message);
        if (back && !this.note?.lasts) this.#settle(message.robot);
    }

    _event({ robot, event }) {
        if (["start", "resume", "clear"].includes(event.event)) this.#settle(robot);
        this.byName(robot)?.takeEvent(event);
        this.twinOf(robot)?.takeEvent(event);
    }

    _twin(message) {
        this.twinOf(message.robot)?.takeCompared(message);
    }

    _prediction(message) {
        this.byName(message.robot)?.takeVerdict(message);
    }

    _outcome(message) {
        this.byName(message.robot)?.takeVerdict(message);
        this.score = message.score ?? this.score;
    }

    _basins(message) {
        const view = this.byName(message.robot);
        if (view) view.picture = message;
    }

    _lost({ robot, records }) {
        const view = this.byName(robot);
        if (view) view.missed += records;
    }

    _baton({ driver, you, asking, why: given }) {
        const why = given.replace(new RegExp(`^page ${this.page}\\b`), "this page");
        if (this.baton.you && !you && why) this.note = { message: why, hint: "" };
        else if (why !== this.baton.why && this.note?.message === this.baton.why) this.note = null;
        this.baton = { driver, you, asking, why };
    }

    _poll(message) {
        this.poll = message;
    }

    _pages({ driving, watching }) {
        this.pages = { driving, watching };
    }

    _note({ robot, message, hint, lasts }) {
        const words = sentences(message, hint);
        this.note = robot
            ? { message: `${robot}: ${words}`, hint: "", robots: [robot], lasts }
            : { message, hint };
    }

    // What went wrong with a robot is over once it is back, or runs.
    #settle(name) {
        if (this.note?.robots?.includes(name)) this.note = null;
    }
}
