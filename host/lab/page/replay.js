/** The page of a replay: a log instead of a robot, and a cursor instead of the present. */

import { byId, element, fillTexts, setText, show } from "./dom.js";
import { createHappened } from "./happened.js";
import { Reel } from "./reel.js";
import { words } from "./replay_texts.js";
import { Screen } from "./screen.js";
import { STATES } from "./robot_view.js";
import { loadTape } from "./tape.js";
import { createTwin } from "./twin.js";
import { sentences } from "./words.js";
import { createWorking } from "./working.js";

// While the log plays, nobody reads equations that change more often, ms.
const READ_MS = 150;

fillTexts(words);
const screen = new Screen();
setText(byId("loading"), words.loading);
try {
    begin(await loadTape());
    show(byId("loading"), false);
} catch (error) {
    setText(byId("loading"), words.failed(error.message));
    window.lab = { state: () => ({ failed: error.message }) };
}

function begin(log) {
    const { tape } = log;
    const reel = new Reel(log, screen, byId, window);
    const { robot, cursor, views, marks, frames } = reel;
    const { columns } = robot.ring;
    const twin = log.twin && createTwin(tape, log.twin, cursor);
    const working = createWorking(byId("working"), tape, robot);
    const happened = createHappened(byId("happened"), marks, cursor, tape.begin_s);
    const about = createAbout(byId("about"), tape);
    let read = 0;
    for (const change of ["click", "keydown"]) addEventListener(change, () => reel.renew(), true);
    // A click leaves the focus on no control, so that the keys move the cursor.
    addEventListener("click", (event) => event.detail > 0 && document.activeElement?.blur());

    reel.onframe = (label) => {
        twin?.update();
        const time = performance.now();
        if (!cursor.playing || time - read > READ_MS) {
            read = time;
            working.update(cursor.place);
        }
        happened();
        about(robot);
        showState(STATES[columns.state[cursor.place]]);
        if (label) twin?.label();
    };
    twin?.add(frames, screen);
    show(byId("log"), true);

    window.lab = {
        state: () =>
            structuredClone({
                log: tape.name,
                place: cursor.place,
                ticks: tape.ticks,
                time_s: cursor.time_s,
                playing: cursor.playing,
                speed: cursor.speed,
                state: STATES[columns.state[cursor.place]],
                record: robot.ring.record(tape.ticks - 1 - cursor.place),
                params: robot.status.params,
                marks,
                verdict: tape.verdict,
                working: working.state(),
                twin: twin?.state() ?? null,
                drawing: {
                    frames: frames.count,
                    p95_ms: frames.p95(),
                    shown_s: views.time,
                    wheels: views.wheels,
                },
            }),
    };
}

function showState(name) {
    byId("now").dataset.state = name;
    setText(byId("now").firstElementChild, words.states[name]);
}

/** What is known of the log: where it comes from, whether it is true, and the parameters. */
function createAbout(root, tape) {
    const { reproduced, first_mismatch, other_sources, damage } = tape.verdict;
    const why = sentences(tape.verdict.why_not_comparable);
    const differences = reproduced ? [] : [first_mismatch, ...other_sources];
    const notes = [damage && words.damage(damage), why, ...differences];
    const verdict = element("p", { className: "verdict" }, words.verdict(tape.verdict));
    verdict.classList.toggle("differs", !reproduced);
    const params = element("dd");
    const twin = tape.twin?.motor;
    const facts = { log: tape.name, part: tape.part, ...tape.facts, twin };
    const rows = Object.entries(facts)
        .filter(([, value]) => value)
        .flatMap(([name, value]) => [
            element("dt", {}, words.facts[name]),
            element("dd", {}, value),
        ]);
    const list = element("dl", {}, ...rows, element("dt", {}, words.facts.params), params);
    if (tape.twin) notes.push(words.twinKept(tape.twin.kicks));
    const said = notes.filter(Boolean).map((note) => element("p", { className: "fine" }, note));
    root.append(verdict, ...said, list);
    byId("log-name").textContent = tape.name;
    document.title = `${tape.name} – ${words.title}`;

    return ({ status }) => {
        const values = ["k", "a", "tau_s", "tick_s", "rods", "rod_lag_s"]
            .filter((name) => name in status.params)
            .map((name) => `${name} = ${status.params[name]}`);
        setText(params, values.join(", "));
    };
}
