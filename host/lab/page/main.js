/** The page of the lab: wires the source, what is known, the panels and the drawings. */

import { aloneTexts } from "./alone_texts.js";
import { createBasins } from "./basins.js";
import { createBaton } from "./baton.js";
import { Beside } from "./beside.js";
import { createClass } from "./class_panel.js";
import { byId, fillTexts, setText } from "./dom.js";
import { addDrawings, labelWheels } from "./drawings.js";
import { Frames } from "./frames.js";
import { Hand } from "./hand.js";
import { createKTrace } from "./k_trace_panel.js";
import { createKicks } from "./kick_panel.js";
import { Lab } from "./lab.js";
import { createLessons } from "./lesson_panel.js";
import { createMovements } from "./movements.js";
import { createNotices } from "./notices.js";
import { createNow } from "./now.js";
import { createParameters } from "./parameters.js";
import { DELAY_TICKS } from "./playout.js";
import { createRecording } from "./recording.js";
import { createSaid } from "./said.js";
import { Screen } from "./screen.js";
import { Sound } from "./sound.js";
import { messagesAddress, WebSocketSource } from "./source.js";
import { createState } from "./state_panel.js";
import { Stop } from "./stop.js";
import { snapshot } from "./snapshot.js";
import { texts } from "./texts.js";
import { Views } from "./views.js";
import { WorkerSource } from "./worker_source.js";

fillTexts(texts);

const alone = Boolean(document.querySelector("meta[name=alone]"));
document.body.classList.toggle("alone", alone);
setText(byId("alone-note"), alone ? aloneTexts.note : "");
const source = alone
    ? new WorkerSource(new URLSearchParams(location.search).get("seed"))
    : new WebSocketSource(messagesAddress());
const lab = new Lab(source);
const stop = new Stop(lab);
const screen = new Screen(() => (lab.changed = true));
const sound = new Sound(byId("sound"));
createSaid(lab);
const kicks = createKicks(byId("kicks"), lab);
const kTrace = createKTrace(byId("k-trace"), byId("k-plane"), lab);
const lessons = createLessons(byId("lessons"), byId("lessons-switch"), lab);
const panels = [
    createNow(lab),
    createNotices(byId("notices"), byId("alarm"), lab),
    kicks.update,
    createMovements(byId("moves"), lab),
    createParameters(byId("parameters"), lab),
    createState(byId("state"), lab),
    createBaton(byId("baton"), lab),
    createBasins(byId("basins"), byId("lag-plane"), lab),
    createRecording(byId("recording"), lab),
    kTrace.update,
    lessons.update,
    createClass(byId("class"), byId("class-switch"), lab, kicks),
    () => stop.update(),
];

/** The views of the robot that is shown; null before the first record. */
let views = null;
let told = 0;

/** @returns {boolean} Whether there is something new to draw. */
function update() {
    const { robot } = lab.store;
    if (robot && views?.robot !== robot) views = new Views(robot);
    const now = performance.now();
    // What counts the time since something happened is renewed now and then, too.
    const due = lab.changed || now - told >= 250;
    const news = lab.changed || (due && lab.fresh);
    if (due) {
        told = now;
        tell();
    }
    // After the panels, which may change what there is to see.
    const moved = [beside.move(now / 1000), lessons.move()];
    if (views) {
        views.linked = lab.store.link.up;
        moved.push(views.update(now / 1000));
        sound.update(views);
    }
    if (due) labelWheels(views);
    return news || moved.includes(true);
}

function tell() {
    const { robot, link } = lab.store;
    lab.changed = lab.fresh = false;
    for (const panel of panels) panel();
    beside.update();
    for (const hand of hands) hand.update();
    document.body.classList.toggle("lost", !link.up || Boolean(robot?.lost));
    if (robot) setText(byId("delay"), texts.delay(1000 * DELAY_TICKS * robot.tick_s));
    byId("hand-note").hidden = !hands[0].allowed;
}

const hands = ["left", "right"].map(
    (side) => new Hand(byId(`${side}-wheel`), side, lab, screen, () => views.angle(side)),
);
const frames = new Frames(update, () => {
    if (lab.store.baton.you) lab.send({ type: "beat" });
});
addDrawings(frames, screen, () => views);
const beside = new Beside(byId("beside"), byId("beside-switch"), { lab, stop, frames, screen });
const kPlane = byId("k-plane");
frames.add(kPlane, kTrace.draw, () => views && [kTrace.view(), screen.themeFor(kPlane, 24, 16)]);
const { canvas: score, draw: drawScore, view: scoreView } = kicks.verdict;
frames.add(score, drawScore, () => [scoreView(), screen.themeFor(score, 22, 6)]);
for (const [canvas, draw, view, letters, lines] of lessons.drawings) {
    frames.add(canvas, draw, () => {
        const now = view();
        return now && [now, screen.themeFor(canvas, letters, lines)];
    });
}

window.lab = { state: () => snapshot({ lab, stop, frames, views, kTrace, sound, beside }) };
if (source.note) lab.tell(source.note);
source.open();
