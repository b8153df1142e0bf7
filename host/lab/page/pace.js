/**
 * When a record of an embedded robot is shown. Its seconds come in milliseconds, while Python waits
 * for it; here they pass as seconds. Who looks is never further behind than this.
 */
const LONGEST_S = 10;

/** Takes the place of a link's playout. */
export class Pace {
    /** @param {import("./ring.js").Ring} ring The robot's records. */
    constructor(ring) {
        this.ring = ring;
        this.restart();
    }

    /** Start again, as when the robot's clock does. */
    restart() {
        this.shown_s = NaN;
        this.at_s = NaN;
    }

    /** A record has arrived; when it does says nothing. */
    arrive() {}

    /**
     * The robot's time that is on the screen.
     * @param {number} now_s The page's clock, s.
     * @param {number} newest_s The time of the newest record, s.
     * @returns {number} s; never later than the newest record.
     */
    time(now_s, newest_s) {
        const { ring } = this;
        if (!ring.length) return NaN;
        const begin_s = ring.columns.t_s[ring.place(ring.length - 1)];
        const next_s = Number.isNaN(this.shown_s) ? begin_s : this.shown_s + now_s - this.at_s;
        this.at_s = now_s;
        this.shown_s = Math.min(newest_s, Math.max(newest_s - LONGEST_S, next_s));
        return this.shown_s;
    }
}
