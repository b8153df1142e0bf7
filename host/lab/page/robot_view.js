/** A robot as the page knows it, from its records, events and states. */

import { Playout } from "./playout.js";
import { Ring } from "./ring.js";

const CAPACITY = 4096;
const HEADER_BYTES = 8;
const KICKS_KEPT = 200;
const FROZEN = ["membrane", "jump"];

/** The robot's states, as numbered in its channel `state`. */
export const STATES = ["idle", "running", "held", "stopped", "fault"];
/** The states in which the motors are off. */
export const AT_REST = ["idle", "stopped", "fault"];

/** One robot, as far as the page knows it. */
export class RobotView {
    /**
     * @param {object} info The robot's entry in the welcome.
     * @param {{records: number, kicks: number}} kept How many are kept.
     */
    constructor(info, kept = { records: CAPACITY, kicks: KICKS_KEPT }) {
        this.info = info;
        this.name = info.name;
        this.ring = new Ring([...info.channels, ...info.derived], kept.records);
        this.playout = new Playout(info.tick_s);
        /** The newest `state` message; of what it does not say, what an earlier one said. */
        this.status = { link: "up", since_s: 0, params: {} };
        this.status_at = performance.now();
        /** @type {object[]} Kicks, oldest first, each with its `prediction` and `outcome`. */
        this.kicks = [];
        this.missed = 0;
        /** @type {?object} The newest `basins` message. */
        this.picture = null;
        /** Where a kick made the membrane potentials jump, in the places of the ring. */
        this.jumped = {
            left: new Uint8Array(kept.records),
            right: new Uint8Array(kept.records),
        };
        this.kicksKept = kept.kicks;
        /** How often the robot has been heard of: a record or a state. */
        this.heard = 0;
        for (const event of info.events ?? []) this.takeEvent(event);
        for (const verdict of info.verdicts ?? []) {
            // A kick whose event is too old to be told must not become the latest one.
            const kick = this.kicks.find(({ id }) => id === verdict.kick_id);
            if (kick) kick[verdict.type] = verdict;
        }
    }

    /** @returns {boolean} Whether the robot itself does not answer. */
    get lost() {
        return this.status.link === "lost";
    }

    /** @returns {boolean} Whether nobody has heard of the robot since the lab began. */
    get unseen() {
        return this.lost && !this.state;
    }

    /** @returns {string} What the robot does: one of STATES, or empty before the first record. */
    get state() {
        return STATES[this.ring.newest("state")] ?? this.status.state ?? "";
    }

    /** @returns {?object} The basins of the robot as it is now, null if these are not known. */
    get basins() {
        const { params: now } = this.status;
        const { params = null } = this.picture ?? {};
        return params && Object.keys(params).every((name) => params[name] === now[name])
            ? this.picture
            : null;
    }

    /** @returns {number} The control period in force, s. */
    get tick_s() {
        return this.status.params.tick_s ?? this.info.tick_s;
    }

    /** Take the records of a binary message. */
    takeRecords(data, now_s) {
        const view = new DataView(data);
        const count = view.getUint16(2, true);
        this.missed += view.getUint32(4, true);
        for (let i = 0; i < count; i += 1) {
            const offset = HEADER_BYTES + i * this.ring.bytes;
            if (view.getUint32(offset, true) <= this.ring.newest("tick")) this.#restart();
            this.push(view, offset);
        }
        if (count) this.playout.arrive(this.ring.newest("t_s"), now_s);
        this.playout.tick_s = this.tick_s;
        this.heard += 1;
    }

    /**
     * Take a record.
     * @param {DataView} view Where it stands.
     * @param {number} offset From which byte on.
     */
    push(view, offset) {
        this.ring.push(view, offset);
        this.#date();
    }

    /** Take an event of the robot. */
    takeEvent(event) {
        if (event.event === "snapshot") {
            this.status.params = { ...this.status.params, ...event.params };
            if (event.kick) this.#addKick(event.kick, event.kick.begin ?? event.tick);
        }
        if (event.event === "params") this.status.params = { ...this.status.params, ...event.set };
        if (event.event === "kick") this.#addKick(event.kick, event.kick.begin ?? event.tick);
    }

    /** Take a `state` message. */
    takeState(message) {
        const known = Object.entries(message).filter(([, value]) => value !== undefined);
        this.status = { ...this.status, ...Object.fromEntries(known) };
        this.status_at = performance.now();
        if (message.link === "up") this.heard += 1;
    }

    /** Remember what the simulation expected of a kick, or what became of it. */
    takeVerdict(message) {
        const kick = this.kicks.findLast(({ id }) => id === message.kick_id);
        if (kick) kick[message.type] = message;
        else this.#add({ id: message.kick_id, [message.type]: message });
    }

    /**
     * How long the robot has been lost.
     * @returns {number} s
     */
    lostFor() {
        return this.status.since_s + (performance.now() - this.status_at) / 1000;
    }

    /** Give kicks the times at which they begin and end, and mark jumps. */
    #date() {
        const [tick, t_s, place] = [
            this.ring.newest("tick"),
            this.ring.newest("t_s"),
            this.ring.place(0),
        ];
        this.jumped.left[place] = this.jumped.right[place] = 0;
        for (let i = this.kicks.length - 1; i >= 0; i -= 1) {
            const kick = this.kicks[i];
            if (kick.end_s !== undefined) break;
            const age = tick - kick.begin;
            if (!(age >= 0)) continue;
            kick.begin_s ??= t_s - age * this.tick_s;
            if (age >= kick.ticks) kick.end_s = t_s;
            else if (FROZEN.includes(kick.mode)) {
                for (const wheel of kick.wheels) this.jumped[wheel][place] = 1;
            }
        }
    }

    #restart() {
        this.ring.clear();
        this.playout.restart();
        this.kicks = [];
    }

    #addKick(kick, begin) {
        const same = this.kicks.findLast(({ id }) => id === kick.id);
        if (same) Object.assign(same, kick, { begin });
        else this.#add({ ...kick, begin });
    }

    #add(kick) {
        this.kicks.push(kick);
        if (this.kicks.length > this.kicksKept) this.kicks.shift();
    }
}
