/**
 * When a record is shown. Records arrive in bursts; shown a little later, by the robot's own clock,
 * they pass evenly.
 */

export const DELAY_TICKS = 1.5;
// How fast the estimate follows a link that has become slower (s per s).
const DRIFT = 0.002;

export class Playout {
    /** @param {number} tick_s The robot's control period, s. */
    constructor(tick_s) {
        this.tick_s = tick_s;
        this.restart();
    }

    /** Start again, as when the robot's clock does. */
    restart() {
        this.lead = Infinity;
        this.seen = 0;
    }

    /**
     * A record has arrived.
     * @param {number} t_s Its time by the robot's clock, s.
     * @param {number} now_s The page's clock, s.
     */
    arrive(t_s, now_s) {
        const slack = this.lead === Infinity ? 0 : DRIFT * (now_s - this.seen);
        this.lead = Math.min(this.lead + slack, now_s - t_s);
        this.seen = now_s;
    }

    /**
     * The robot's time that is on the screen.
     * @param {number} now_s The page's clock, s.
     * @param {number} newest_s The time of the newest record, s.
     * @returns {number} s; never later than the newest record.
     */
    time(now_s, newest_s) {
        return Math.min(newest_s, now_s - this.lead - DELAY_TICKS * this.tick_s);
    }
}
