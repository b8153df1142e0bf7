/** Which tick of a log is on the screen, and how it moves on by itself. */

// A page that was hidden or busy does not catch up, and nobody waits through a longer gap, s.
const LONGEST_STEP_S = 0.25;
const LONGEST_WAIT_S = 1;

export class Cursor {
    #before = 0;

    /** @param {Float64Array} times The times of all ticks, s, ascending. */
    constructor(times) {
        this.times = times;
        this.place = 0;
        this.time_s = times[0];
        this.playing = false;
        /** How many seconds of the log pass in a second. */
        this.speed = 1;
    }

    /** The time that is on the screen, s: the views ask for it like a link's playout. */
    time() {
        return this.time_s;
    }

    /** Go to a tick, or to the nearest one that there is. */
    go(place) {
        this.place = Math.max(0, Math.min(this.times.length - 1, place));
        this.time_s = this.times[this.place];
    }

    /** Go to the tick at a time, s. */
    seek(time_s) {
        let [low, high] = [0, this.times.length];
        while (low + 1 < high) {
            const middle = (low + high) >> 1;
            if (this.times[middle] <= time_s) low = middle;
            else high = middle;
        }
        this.go(low);
    }

    /** Play, from the beginning if the cursor is at the end; or pause. */
    toggle() {
        this.playing = !this.playing;
        if (this.playing && this.place === this.times.length - 1) this.go(0);
        // On a pause the screen shows a tick, and nothing between two.
        if (!this.playing) this.go(this.place);
    }

    /** @param {number} now_s The page's clock, s. */
    advance(now_s) {
        const passed = Math.min(now_s - this.#before, LONGEST_STEP_S);
        this.#before = now_s;
        if (!this.playing) return;
        const { times } = this;
        this.time_s += passed * this.speed;
        while (times[this.place + 1] <= this.time_s) this.place += 1;
        if (times[this.place + 1] - this.time_s > LONGEST_WAIT_S) this.go(this.place + 1);
        if (this.place === times.length - 1) this.toggle();
    }
}
