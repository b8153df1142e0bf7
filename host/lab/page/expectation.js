/** What the simulation expects of each usual kick, said once a person has guessed. */

/**
 * @param {import("./lab.js").Lab} lab
 * @param {object[]} kicks The kicks to ask about, without their wheels.
 * @returns {{renew: (wheel: ?string) => void, of: (n: number) => ?object}} `renew` takes the kicked
 *     wheels, or null if nothing is to be asked; `of` gives the prediction `{shares, of}` of a
 *     kick, null if there is none.
 */
export function createExpectation(lab, kicks) {
    let [about, wheel, busy] = ["", null, false];
    /** By kick: the prediction, null if there is none, undefined while it is open. */
    let answers = [];

    // The lab answers one question of a page at a time.
    const ask = async () => {
        if (busy) return;
        busy = true;
        while (wheel && answers.includes(undefined)) {
            const [open, n] = [answers, answers.indexOf(undefined)];
            const robot = lab.store.robot.name;
            const kick = { ...kicks[n], wheel };
            // A person did not ask for it, and can kick without: nothing is said if it fails.
            open[n] = await lab.request({ type: "predict", robot, kick }).catch(() => null);
            lab.changed = true;
        }
        busy = false;
    };

    const renew = (wheels) => {
        const { robot } = lab.store;
        // What was expected holds until somebody kicks, or changes the robot.
        const now = wheels && [wheels, robot.name, robot.kicks.at(-1)?.id, robot.status.params];
        const key = JSON.stringify(now);
        if (key === about) return;
        [about, wheel, answers] = [key, wheels, kicks.map(() => undefined)];
        ask();
    };
    return { renew, of: (n) => answers[n] ?? null };
}
