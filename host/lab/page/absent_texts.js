/** The words of robots that do not run, or do not answer. */

import { texts } from "./texts.js";
import { number, sentences } from "./words.js";

export const absentTexts = {
    unseen: "Not there yet",
    notThere: "The page finds it when it comes.",
    hadStopped: (seconds) => `It had stopped when it was last heard, ${number(seconds, 0)} s ago.`,
    press: {
        start: "press its Start",
        clear: "mend the cause, then press its Clear the fault",
    },
    /** What STOP says on a page that is not let in. */
    cannotStop: (refused) =>
        sentences(
            "this page cannot stop anything",
            refused?.title ?? "the lab did not let it in",
            "lift the robot, press its back button, or type `kickctl stop`",
        ),
    /** What to do where another program drives the robot. */
    drivenElsewhere: (controller) =>
        `wait until they have finished, or press ‘${texts.takeOver(controller ?? "them")}’ under` +
        ` ${texts.state}. Anyone may stop the robot: press ${texts.stopButton}`,
    noneRuns: "No robot runs.",
    /** Why one of several cannot be kicked. */
    notKicked: (robot) => {
        const { name, status } = robot;
        if (robot.unseen) return `${name} is not there yet.`;
        if (robot.lost) return `${name} is lost: no word from it for ${seconds(robot)} s.`;
        return `${name} does not run. ${sentences(absentTexts.press[status.remedy])}`.trim();
    },
    /** Why the only one cannot be kicked. */
    notKickedAlone: (robot) => {
        if (robot.unseen) return "The robot is not there yet, so it cannot be kicked.";
        return robot.lost ? "The robot is lost, so it cannot be kicked now." : texts.startFirst;
    },
};

const seconds = (robot) => number(robot.lostFor(), 0);
