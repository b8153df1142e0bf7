/** The words of the widgets that the pages have not. */

import { capital, sentences } from "./words.js";
import { texts } from "./texts.js";

export const words = {
    ...texts,
    stopButton: "STOP",
    stopLabel: (robot) => `Stop ${robot}`,
    embedded: "Its time passes while Python waits for it, and is shown in seconds.",
    embeddedWaits: "Its time passes only while Python waits: run robot.wait(3).",
    lost: (seconds, closed) => sentences(closed || texts.lostFor(seconds)),
    reason: (why) => sentences(why),
    waiting: "Waiting for the robot's first records …",
    stopped: (said) => `${capital(said)}.`,
    failed: ({ message, hint }) => sentences(message, hint),
    unconfirmed:
        "NOT confirmed. If a cell runs, interrupt it by ■ above. Look at the wheels: lift the" +
        " robot, or press its back button.",
};
