/** A robot from a log: all records are there, and a cursor says which one is on the screen. */

import { RobotView } from "./robot_view.js";

export class RecordedRobot extends RobotView {
    #settings = [];

    /**
     * @param {object} tape As MESSAGES.md says.
     * @param {DataView} records Its packed records.
     */
    constructor(tape, records) {
        super(tape.robot, { records: tape.ticks, kicks: Infinity });
        let next = 0;
        for (let place = 0; place <= tape.ticks; place += 1) {
            for (; tape.events[next]?.place === place; next += 1) {
                const { event } = tape.events[next];
                if (event.event === "restart") this.#endKicks();
                this.takeEvent(event);
                this.#settings.push({ place, params: this.status.params });
            }
            if (place < tape.ticks) this.push(records, place * this.ring.bytes);
        }
    }

    /** Show the parameters that were in force in a tick. */
    setPlace(place) {
        const { params } = this.#settings.findLast((one) => one.place <= place);
        if (this.status.params !== params) this.status = { ...this.status, params };
    }

    /** The robot's program began again, and counts ticks from 0. */
    #endKicks() {
        for (const kick of this.kicks) {
            kick.begin_s ??= NaN;
            kick.end_s ??= this.ring.newest("t_s");
        }
    }
}
