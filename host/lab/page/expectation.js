/** What the simulation expects of each usual kick, said once a person has guessed. */

// Walls and hands change what a robot does, too: what was expected is asked again after this time.
const FRESH_MS = 10000;

/**
 * @param {import("./lab.js").Lab} lab
 * @param {object[]} kicks The kicks to ask about, without their wheels.
 * @returns {{renew: (wheel: ?string) => void, of: (n: number) => ?object}} `renew` takes the kicked
 *     wheels, or null if nothing is to be asked; `of` gives the prediction `{shares, of}` of a
 *     kick, null if there is none.
 */
export function createExpectation(lab, kicks) {
    let [about, wheel, answers] = ["", null, []];
    let [next, asked, busy] = [0, 0, false];

    // The lab answers one question of a page at a time.
    const ask = async () => {
        if (busy) return;
        busy = true;
        while (wheel && next < kicks.length) {
            const then = about;
            const robot = lab.store.robot.name;
            const kick = { ...kicks[next], wheel };
            // A person did not ask for it, and can kick without: nothing is said if it fails.
            const answer = await lab.request({ type: "predict", robot, kick }).catch(() => null);
            if (then !== about) continue;
            answers[next] = answer;
            next += 1;
            lab.changed = true;
        }
        busy = false;
    };

    const renew = (wheels) => {
        const { robot } = lab.store;
        const key = JSON.stringify(
            wheels && [wheels, robot.name, robot.kicks.at(-1)?.id, robot.status.params],
        );
        const now = performance.now();
        if (key !== about) [about, wheel, answers] = [key, wheels, []];
        else if (next < kicks.length || now - asked < FRESH_MS) return;
        [next, asked] = [0, now];
        ask();
    };
    return { renew, of: (n) => answers[n] ?? null };
}
