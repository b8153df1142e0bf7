/** The simulated twin of a robot as the page knows it. It does what its robot is asked to. */

import { RobotView } from "./robot_view.js";

export class TwinView extends RobotView {
    /**
     * @param {object} info The twin's entry in the welcome.
     * @param {RobotView} robot Its robot.
     */
    constructor(info, robot) {
        super({ ...robot.info, verdicts: [], ...info });
        this.robot = robot;
        /** What is shown of both at a time is of the same tick. */
        this.playout = robot.playout;
        /** @type {?object} The newest `twin` message. */
        this.compared = info.compared.at(-1) ?? null;
        /** In how many kicks both did the same, and of how many. */
        this.score = info.score;
    }

    get lost() {
        return this.robot.lost;
    }

    get state() {
        return this.robot.state;
    }

    get tick_s() {
        return this.robot?.tick_s ?? this.info.tick_s;
    }

    /** Take a `twin` message. */
    takeCompared(message) {
        this.compared = message;
        this.score = message.score;
    }
}
