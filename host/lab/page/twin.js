/** The simulated twin of a logged robot: its wheels and strips, at the same cursor. */

import { byId, show } from "./dom.js";
import { labelWheels } from "./drawings.js";
import { draw as drawStrips } from "./draw/strips.js";
import { draw as drawWheel } from "./draw/wheel.js";
import { RecordedRobot } from "./recorded.js";
import { Views } from "./views.js";

/**
 * @param {object} tape
 * @param {{derived: object[], records: DataView}} twin
 * @param {import("./cursor.js").Cursor} cursor
 * @returns {{add: Function, update: Function, label: Function, state: () => object}}
 */
export function createTwin(tape, twin, cursor) {
    const robot = new RecordedRobot(
        { ...tape, robot: { ...tape.robot, derived: twin.derived } },
        twin.records,
    );
    robot.playout = cursor;
    const views = new Views(robot);
    views.linked = true;
    document.documentElement.classList.add("twins");
    for (const section of document.querySelectorAll(".twin, .twin-strips")) show(section, true);
    return {
        add: (frames, screen) => {
            const drawings = [
                ["twin-left", drawWheel, () => views.wheels.left, 21, 19],
                ["twin-right", drawWheel, () => views.wheels.right, 21, 19],
                ["twin-strips", drawStrips, () => views.strips, 30, 16],
            ];
            for (const [id, draw, view, letters, lines] of drawings) {
                const canvas = byId(id);
                const seen = () => [view(), screen.themeFor(canvas, letters, lines)];
                frames.add(canvas, draw, seen);
            }
        },
        update: () => {
            robot.setPlace(cursor.place);
            views.update();
        },
        label: () => labelWheels(views, byId, ["twin-left", "twin-right"]),
        state: () => ({ ...tape.twin, wheels: views.wheels }),
    };
}
