/** The model wheel of a guided exercise: let it go, watch it, read off what it did. */

import { button, element, numberField, setText, show } from "./dom.js";
import { draw as drawPlane } from "./draw/plane.js";
import { draw as drawWheel } from "./draw/wheel.js";
import { modelTexts } from "./lesson_texts.js";
import { texts } from "./texts.js";

const STILL = matchMedia("(prefers-reduced-motion: reduce)");
// Where ln d lies, from twins at their start to wheels that have nothing in common.
const LN_D = { minimum: -15, maximum: 5 };
// How many runs with different settings are drawn together.
const COMPARED = 2;

/**
 * @param {import("./lesson.js").Lesson} lesson
 * @returns {{root: HTMLElement, update: () => void, move: () => boolean,
 *     drawings: [HTMLCanvasElement, Function, () => ?object, number, number][]}} `move`: moves all
 *     to what is on the screen now, and says whether that is something new; `drawings`: each with
 *     its canvas, what draws it, what it shows now, and for how many letters and lines it needs
 *     room.
 */
export function createModelBench(lesson) {
    const choice = numberField("model-value", "", {});
    const go = button("", () => release(), "go");
    const own = numberField("own-number", "", { step: "any" });
    const wheels = [0, 1].map(() => element("canvas", { role: "img" }));
    const plane = element("canvas", { role: "img" });
    const figures = element("div", { className: "model" }, ...wheels, plane);
    const note = element("p", { className: "fine" });
    const list = element("ul");
    const all = element("p", { role: "status" });
    const controls = element("div", { className: "buttons" }, choice.root, go);
    const root = element("div", { className: "bench" });
    const found = element("div", { className: "buttons" }, own.root);
    root.append(element("h3", {}, modelTexts.label), note, controls, figures, found, all, list);

    let name = "";
    let known = null;
    /** The runs of this exercise since the page was loaded, and when the last one began, ms. */
    let shown = [];
    let began = 0;
    /** How many states of the newest run are on the screen. */
    let reached = 0;

    own.input.oninput = () => {
        const { value, valueAsNumber } = own.input;
        lesson.answer(value && Number.isFinite(valueAsNumber) ? valueAsNumber : null);
    };

    function release() {
        const { model } = lesson.texts;
        if (model.choose && !choice.input.reportValidity()) return;
        const value = model.choose ? choice.input.valueAsNumber : lesson.state.runs.length + 1;
        lesson.run(value, (run) => {
            shown.push({ ...run, value });
            [began, reached] = [performance.now(), 0];
        });
    }

    function update() {
        const { texts: exercise, state } = lesson;
        const { model } = exercise;
        // A run takes a while; until it is there, the pupil's own k stays.
        if (name !== exercise.name || (known !== state && !state.runs.length)) {
            name = exercise.name;
            shown = [];
            Object.assign(choice.input, { min: model.least, max: model.most, step: model.step });
            choice.input.value = model.least;
            own.input.value = state.own ?? "";
        }
        known = state;
        const words = modelTexts[name];
        setText(note, modelTexts.note(model));
        setText(choice.label, model.choose ?? "");
        setText(go, model.run);
        setText(own.label, model.own);
        go.disabled = false;
        own.input.disabled = state.done;
        show(controls, !state.done);
        show(choice.root, Boolean(model.choose));
        show(figures, shown.length > 0);
        wheels.forEach((canvas, n) => {
            show(canvas, n < words.wheels.length);
            canvas.setAttribute("aria-label", words.wheels[n] ?? "");
        });
        plane.setAttribute("aria-label", `${words.symbol}, t`);
        list.replaceChildren(...state.runs.map((run) => element("li", {}, words.line(run))));
        setText(all, state.runs.length ? words.all(state.runs) : "");
    }

    function move() {
        const before = reached;
        if (!shown.length || !lesson.texts) return false;
        const { t_s } = shown.at(-1);
        const now_s = ((performance.now() - began) / 1000) * lesson.texts.model.speed;
        const passed = STILL.matches ? t_s.length : 1 + Math.floor(now_s / t_s[1]);
        reached = Math.min(t_s.length, passed);
        return reached !== before;
    }

    function wheelView(n) {
        const run = shown.at(-1);
        if (!run?.wheels[n] || !lesson.texts) return null;
        const now = Object.entries(run.wheels[n]).map(([name, values]) => [
            name,
            values[reached - 1],
        ]);
        const title = modelTexts[name].wheels[n];
        return { ...Object.fromEntries(now), title, labels: texts.wheelLabels };
    }

    function planeView() {
        const run = shown.at(-1);
        if (!run || !lesson.texts) return null;
        const words = modelTexts[name];
        const varied = Boolean(lesson.texts.model.choose);
        const drawn = varied ? shown.slice(-COMPARED) : shown;
        const traces = drawn.map(({ t_s, curve, value }) => {
            const newest = curve === run.curve;
            const [colour, dashed] = newest ? ["left1", false] : ["right1", varied];
            return { x: t_s, y: curve, colour, dashed, name: words.name({ value }) };
        });
        const most = Math.ceil(10 * Math.max(...drawn.flatMap(({ curve }) => curve))) / 10;
        const range = varied ? { minimum: -most, maximum: most } : LN_D;
        return {
            x: { symbol: "t", unit: "s", minimum: 0, maximum: run.t_s.at(-1) },
            y: { symbol: words.symbol, unit: words.unit, ...range },
            traces,
            count: reached,
            even: true,
        };
    }

    const drawings = [
        ...wheels.map((canvas, n) => [canvas, drawWheel, () => wheelView(n), 21, 19]),
        [plane, drawPlane, planeView, 30, 14],
    ];
    return { root, update, move, drawings };
}
