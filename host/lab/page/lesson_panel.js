/** The guided exercises: a question, a locked prediction, free play, a check, an explanation. */

import { button, choices, element, setText, show } from "./dom.js";
import { Lesson } from "./lesson.js";
import { lessonTexts } from "./lesson_texts.js";
import { createModelBench } from "./model_bench.js";

/**
 * @param {HTMLElement} root
 * @param {HTMLButtonElement} opener Opens and closes the panel.
 * @param {import("./lab.js").Lab} lab
 * @returns {{update: () => void, move: () => boolean, drawings: object[]}} `update` brings the
 *     panel up to date; `move` and `drawings` are those of the model wheel, see model_bench.js.
 */
export function createLessons(root, opener, lab) {
    const lesson = new Lesson(lab);
    const bench = createModelBench(lesson);
    let open = false;
    let shown = "";
    setText(opener, lessonTexts.button);
    opener.setAttribute("aria-label", lessonTexts.buttonLabel);
    root.setAttribute("aria-label", lessonTexts.title);
    opener.onclick = () => {
        open = !open;
        lab.changed = true;
    };

    const update = () => {
        const { robot, canDrive, role } = lab.store;
        open = lesson.meet() || open;
        show(opener, canDrive || role === "drive");
        opener.setAttribute("aria-pressed", String(open));
        show(root, open && Boolean(robot));
        if (robot) lesson.follow();
        if (root.hidden) return;
        if (!lesson.all.length) lesson.load();
        const { all, done, state, busy } = lesson;
        // While somebody types a number, nothing around it is renewed.
        const known = { ...state, own: state?.own == null };
        const now = JSON.stringify([all.length, done, known, busy, canDrive, robot.name]);
        if (now === shown) return;
        shown = now;
        const focused = root.contains(document.activeElement) ? document.activeElement.id : "";
        root.replaceChildren(...(lesson.texts ? steps(lesson, robot, bench) : list(lesson)));
        for (const control of root.querySelectorAll("button, fieldset")) {
            control.disabled ||= busy || !canDrive;
        }
        if (focused) document.getElementById(focused)?.focus();
    };
    return { update, move: bench.move, drawings: bench.drawings };
}

/** All exercises. */
function list(lesson) {
    const buttons = lesson.all.map(({ name, title }, n) => {
        const mark = lesson.done.includes(name) ? ` ${lessonTexts.ok}` : "";
        return button(`${n + 1} ${title}${mark}`, () => lesson.choose(name));
    });
    return [
        element("h2", {}, lessonTexts.title),
        element("p", {}, lessonTexts.intro),
        element("div", { className: "buttons" }, ...buttons),
    ];
}

/** The exercise that goes on, as far as it has come. */
function steps(lesson, robot, bench) {
    const { texts, state } = lesson;
    const last = button(lessonTexts.leave, () => lesson.leave(), "quiet");
    const before = [
        element("h2", {}, texts.title),
        element("p", { className: "question" }, texts.question),
        ...(state.locked ? task(lesson) : predict(lesson, robot)),
    ];
    const after = [
        ...(state.locked ? found(lesson) : []),
        ...(state.done ? explain(lesson) : []),
        element("div", { className: "buttons" }, ...forward(lesson), last),
    ];
    if (!texts.model || !state.locked) return [...before, ...after];
    bench.update();
    const part = (parts) => element("div", { className: "asked" }, ...parts);
    return [element("div", { className: "beside" }, part(before), bench.root, part(after))];
}

function predict(lesson, robot) {
    const { texts, state } = lesson;
    const { label, walls } = robot.info;
    if (texts.walls && walls === null && label !== "real") {
        return [element("p", {}, lessonTexts.walls)];
    }
    const answers = texts.answers.map((label, value) => ({ value, label }));
    const group = choices("prediction", lessonTexts.prediction, answers, state.guess, (answer) =>
        lesson.guess(answer),
    );
    group.classList.add("long");
    const lock = button(lessonTexts.lock, () => lesson.lock(), "go");
    lock.disabled = state.guess === null;
    return [group, lock];
}

function task({ texts, state }) {
    const guess = lessonTexts.locked(texts.answers[state.guess]);
    const locked = element("p", { className: "locked" }, guess);
    if (state.done) return [locked];
    const hints = texts.hints.slice(0, state.hints).map((words) => element("li", {}, words));
    return [locked, element("p", {}, texts.task), element("ul", {}, ...hints)];
}

/** What a check has found. */
function found({ texts, state, busy, checking }) {
    const { ok, missing } = lessonTexts;
    const verdict = element("p", { role: "status" });
    if (checking) verdict.append(lessonTexts.checking);
    else if (busy && texts.model) verdict.append(lessonTexts.computing);
    else if (state.findings.length) verdict.append(lessonTexts[state.done ? "done" : "notYet"]);
    const findings = state.findings.map((one) =>
        element("li", {}, element("b", {}, one.ok ? ok : missing), ` ${one.words}`),
    );
    return [verdict, element("ul", { className: "findings" }, ...findings)];
}

function explain({ texts, state }) {
    const [guess, answer] = [texts.answers[state.guess], texts.answers[texts.right]];
    const verdict =
        state.guess === texts.right ? lessonTexts.right(answer) : lessonTexts.wrong(guess, answer);
    return [
        element("p", { className: "verdict-line" }, verdict),
        element("p", {}, texts.explanation),
        element("p", {}, lessonTexts.misconception(texts.misconception)),
    ];
}

/** The buttons that lead on. */
function forward(lesson) {
    const { all, texts, state } = lesson;
    if (!state.locked) return [];
    if (state.done) {
        const next = all[all.indexOf(texts) + 1];
        return next ? [button(lessonTexts.next, () => lesson.choose(next.name), "go")] : [];
    }
    const check = button(lessonTexts.check, () => lesson.check(), "go");
    const hint = button(lessonTexts.hint, () => lesson.hint());
    hint.disabled = state.hints >= texts.hints.length;
    return [check, hint];
}
