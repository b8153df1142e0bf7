/** What a person sees who moves k: how fast and how hard the wheels turn at each k held. */

// The mean of this last time counts, once k has been held for as long as that.
const WINDOW_S = 1;
const MOST = 200;
const SIDES = ["left", "right"];
// With another of these parameters, a new trace begins.
const OTHERS = ["a", "tau_s", "rods"];

/**
 * @typedef {Object} Hold
 * @property {number} k
 * @property {?boolean} up whether k was raised to it; null if the robot began with it
 * @property {{left: ?Means, right: ?Means}} means null as long as it has not been held for long
 */

/**
 * @typedef {Object} Means
 * @property {number} omega_rad_s mean of its amount, rad/s
 * @property {number} torque mean of |M|
 */

export class KTrace {
    #begin = 0;
    #others = "";

    /** @param {import("./robot_view.js").RobotView} robot */
    constructor(robot) {
        this.robot = robot;
        /** @type {Hold[]} Oldest first. */
        this.holds = [];
    }

    /** Forget all but the present k. */
    clear() {
        const last = this.holds.at(-1);
        this.holds = last ? [{ ...last, up: null }] : [];
    }

    /** Take in what has come since. */
    update() {
        const { ring, state, status } = this.robot;
        const { k } = status.params;
        if (k === undefined) return;
        const others = OTHERS.map((name) => status.params[name]).join();
        if (others !== this.#others) [this.#others, this.holds] = [others, []];
        const last = this.holds.at(-1);
        if (last?.k !== k) {
            // A k that nobody has held leaves no mark.
            if (last && !last.means.left) this.holds.pop();
            const up = last ? k > last.k : null;
            this.holds.push({ k, up, means: { left: null, right: null } });
            if (this.holds.length > MOST) this.holds.shift();
            this.#begin = ring.newest("t_s");
        }
        const now = ring.newest("t_s");
        // Only a robot that runs holds a k; after a restart its time begins at 0.
        if (state !== "running" || !(now >= this.#begin)) this.#begin = now;
        if (!(now - this.#begin >= WINDOW_S)) return;
        for (const side of SIDES) this.holds.at(-1).means[side] = this.#means(side, now);
    }

    #means(side, now) {
        const { ring } = this.robot;
        const { t_s, [`${side}_omega_rad_s`]: omega, [`${side}_torque`]: torque } = ring.columns;
        let [count, speed, hard] = [0, 0, 0];
        for (let age = 0; age < ring.length && t_s[ring.place(age)] > now - WINDOW_S; age += 1) {
            const place = ring.place(age);
            speed += Math.abs(omega[place]);
            hard += Math.abs(torque[place]);
            count += 1;
        }
        return { omega_rad_s: speed / count, torque: hard / count };
    }
}
