/** What the simulation expects of a kick beside what the robot did, and the score of guesses. */

import { draw } from "./draw/score.js";
import { element, setText, show } from "./dom.js";
import { texts } from "./texts.js";

const SIDES = ["left", "right"];

/**
 * @param {import("./lab.js").Lab} lab
 * @returns {{root: HTMLElement, canvas: HTMLCanvasElement, draw: Function,
 *     view: () => object, update: (robot: object) => void,
 *     showExpected: (kick: object, prediction: object) => void}}
 */
export function createVerdict(lab) {
    const title = element("h3");
    const canvas = element("canvas", { className: "score", role: "presentation" });
    const sentences = element("ul", { className: "sentences" });
    const guess = element("p", { className: "own-guess" });
    const score = element("p", { className: "score-line" });
    const parts = [title, canvas, sentences, guess, score];
    const root = element("div", { className: "verdict" }, ...parts);
    const view = { wheels: [], labels: texts.scoreLabels };
    let asked = null;

    const update = (robot) => {
        const newest = robot.kicks.at(-1);
        if (asked && (asked.robot !== robot || asked.after !== newest)) asked = null;
        const kick = asked ?? newest;
        setText(title, kick ? (asked ? texts.ifNow : texts.lastKick)(kick) : texts.noKick);
        const { prediction, outcome } = kick ?? {};
        const known = Boolean(prediction || outcome);
        show(canvas, known);
        show(sentences, known);
        const sides = SIDES.filter((side) => kick && (kick.wheels ?? SIDES).includes(side));
        view.of = prediction?.of ?? 0;
        view.wheels = sides.map((side) => ({
            name: texts.sides[side],
            shares: prediction?.shares?.[side] ?? null,
            outcome: outcome?.result?.[side] ?? null,
            rested: outcome?.before?.[side] === "stopped",
        }));
        const said = outcome?.why
            ? [texts.noOutcome(outcome.why)]
            : view.wheels.map((wheel) => texts.verdict(wheel, view.of));
        if (said.join() !== [...sentences.children].map((item) => item.textContent).join()) {
            sentences.replaceChildren(...said.map((words) => element("li", {}, words)));
        }
        const guessed = outcome?.guess ?? kick?.guess?.guess;
        setText(guess, guessed ? texts.ownGuess(guessed, outcome?.right ?? null) : "");
        setText(score, texts.score(lab.store.score));
    };

    const showExpected = (kick, prediction) => {
        const { robot } = lab.store;
        const wheels = kick.wheel === "both" ? SIDES : [kick.wheel];
        asked = { ...kick, wheels, prediction, robot, after: robot.kicks.at(-1) };
        lab.changed = true;
    };

    return { root, canvas, draw, view: () => view, update, showExpected };
}
