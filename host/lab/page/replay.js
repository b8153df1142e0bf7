/** The page of a replay: a log instead of a robot, and a cursor instead of the present. */

import { Cursor } from "./cursor.js";
import { byId, element, fillTexts, setText, show } from "./dom.js";
import { draw as drawMarks } from "./draw/marks.js";
import { addDrawings, labelWheels } from "./drawings.js";
import { Frames } from "./frames.js";
import { createHappened } from "./happened.js";
import { marksOf } from "./marks.js";
import { createPlayer } from "./player.js";
import { RecordedRobot } from "./recorded.js";
import { words } from "./replay_texts.js";
import { Screen } from "./screen.js";
import { STATES } from "./store.js";
import { loadTape } from "./tape.js";
import { createTwin } from "./twin.js";
import { Views } from "./views.js";
import { sentences } from "./words.js";
import { createWorking } from "./working.js";

// How many frames are drawn after the last change: what scrolls into view is drawn, too.
const FRAMES_AFTER = 30;
// While the log plays, nobody reads equations that change more often, ms.
const READ_MS = 150;
// Half of the width of the slider's thumb, CSS pixels.
const THUMB = 8;

fillTexts(words);
const screen = new Screen();
setText(byId("loading"), words.loading);
try {
    const { tape, records, twin } = await loadTape();
    begin(tape, new RecordedRobot(tape, records), twin);
    show(byId("loading"), false);
} catch (error) {
    setText(byId("loading"), words.failed(error.message));
    window.lab = { state: () => ({ failed: error.message }) };
}

function begin(tape, robot, twinTape) {
    const { columns } = robot.ring;
    const cursor = new Cursor(columns.t_s);
    robot.playout = cursor;
    const views = new Views(robot);
    views.linked = true;
    const twin = twinTape && createTwin(tape, twinTape, cursor);
    const marks = marksOf(tape, robot.ring);
    const log = { marks, ticks: columns.tick, begin_s: tape.begin_s };
    const player = createPlayer(byId("player"), cursor, log);
    const working = createWorking(byId("working"), tape, robot);
    const happened = createHappened(byId("happened"), marks, cursor, tape.begin_s);
    const about = createAbout(byId("about"), tape);
    let labelled = null;
    let drawn = [];
    let left = 0;
    let read = 0;
    const renew = () => (left = FRAMES_AFTER);
    for (const change of ["scroll", "resize", "click", "keydown"]) {
        addEventListener(change, renew, true);
    }

    const frames = new Frames(
        () => {
            cursor.advance(performance.now() / 1000);
            left -= 1;
            const now = [cursor.time_s, screen.theme];
            if (now.some((one, n) => one !== drawn[n])) renew();
            drawn = now;
            if (left <= 0) return;
            robot.setPlace(cursor.place);
            views.update();
            twin?.update();
            player();
            const time = performance.now();
            if (!cursor.playing || time - read > READ_MS) {
                read = time;
                working.update(cursor.place);
            }
            happened();
            about(robot);
            showState(STATES[columns.state[cursor.place]]);
            if (!cursor.playing && labelled !== cursor.place) {
                labelled = cursor.place;
                labelWheels(views);
                twin?.label();
            }
        },
        () => {},
    );
    addDrawings(frames, screen, () => (left > 0 ? views : null));
    twin?.add(frames, screen, () => left > 0);
    const band = byId("marks");
    const state = { marks, count: tape.ticks, edge: THUMB };
    frames.add(band, drawMarks, () => left > 0 && [state, screen.themeFor(band, 1, 1.5)]);
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
