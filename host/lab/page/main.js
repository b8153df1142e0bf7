/** The page of the lab: wires the source, what is known, the panels and the drawings. */

import { createBasins } from "./basins.js";
import { createBaton } from "./baton.js";
import { createClass } from "./class_panel.js";
import { byId, element, setText } from "./dom.js";
import { draw as drawFloor } from "./draw/floor.js";
import { draw as drawPlane } from "./draw/plane.js";
import { draw as drawStrips } from "./draw/strips.js";
import { draw as drawWheel } from "./draw/wheel.js";
import { Frames } from "./frames.js";
import { onBasins } from "./ground.js";
import { Hand } from "./hand.js";
import { createKTrace } from "./k_trace_panel.js";
import { createKicks } from "./kick_panel.js";
import { Lab } from "./lab.js";
import { createMovements } from "./movements.js";
import { createNotices } from "./notices.js";
import { createNow } from "./now.js";
import { createParameters } from "./parameters.js";
import { DELAY_TICKS } from "./playout.js";
import { createRecording } from "./recording.js";
import { createSaid } from "./said.js";
import { Screen } from "./screen.js";
import { WebSocketSource } from "./source.js";
import { createState } from "./state_panel.js";
import { Stop } from "./stop.js";
import { snapshot } from "./snapshot.js";
import { texts } from "./texts.js";
import { Views } from "./views.js";

for (const target of document.querySelectorAll("[data-text]")) {
    target.textContent = texts[target.dataset.text];
}
for (const target of document.querySelectorAll("[data-label]")) {
    target.setAttribute("aria-label", texts[target.dataset.label]);
}

byId("key").append(
    ...Object.entries(texts.key).map(([mark, words]) =>
        element("li", { className: `mark-${mark}`, title: texts.keyHints[mark] ?? "" }, words),
    ),
);

const address = new URL("messages", location.href);
address.protocol = address.protocol.replace("http", "ws");
address.hash = "";
const source = new WebSocketSource(address.href);
const lab = new Lab(source);
const stop = new Stop(lab);
const screen = new Screen();
createSaid(lab);
const kicks = createKicks(byId("kicks"), lab);
const kTrace = createKTrace(byId("k-trace"), byId("k-plane"), lab);
const panels = [
    createNow(lab),
    createNotices(byId("notices"), lab),
    kicks.update,
    createMovements(byId("moves"), lab),
    createParameters(byId("parameters"), lab),
    createState(byId("state"), lab),
    createBaton(byId("baton"), lab),
    createBasins(byId("basins"), byId("lag-plane"), lab),
    createRecording(byId("recording"), lab),
    kTrace.update,
    createClass(byId("class"), byId("class-switch"), lab, kicks),
    () => stop.update(),
];

/** The views of the robot that is shown; null before the first record. */
let views = null;
let told = 0;

function update() {
    const { robot, link } = lab.store;
    if (robot && views?.robot !== robot) views = new Views(robot);
    const now = performance.now();
    if (views) {
        views.linked = link.up;
        views.update(now / 1000);
    }
    // What counts the time since something happened is renewed now and then, too.
    if (!lab.changed && now - told < 250) return;
    lab.changed = false;
    told = now;
    for (const panel of panels) panel();
    for (const hand of hands) hand.update();
    document.body.classList.toggle("lost", !link.up || Boolean(robot?.lost));
    if (robot) setText(byId("delay"), texts.delay(1000 * DELAY_TICKS * robot.tick_s));
    byId("hand-note").hidden = !hands[0].allowed;
    for (const side of ["left", "right"]) {
        byId(`${side}-wheel`).setAttribute(
            "aria-label",
            texts.wheelLabel(side, views?.wheels[side]),
        );
    }
}

const hands = ["left", "right"].map(
    (side) => new Hand(byId(`${side}-wheel`), side, lab, screen, () => views.angle(side)),
);
const frames = new Frames(update, () => {
    if (lab.store.baton.you) lab.send({ type: "beat" });
});
// Each with the room that its text needs: letters in a line, and lines.
const drawings = [
    ["left-wheel", drawWheel, () => views.wheels.left, 21, 19],
    ["right-wheel", drawWheel, () => views.wheels.right, 21, 19],
    ["strips", drawStrips, () => views.strips, 30, 16],
    ["lag-plane", onBasins(drawPlane), () => views.lag, 17, 10],
    ["phi-plane", drawPlane, () => views.phi, 17, 10],
    ["x-plane", drawPlane, () => views.x, 17, 10],
    ["floor", drawFloor, () => views.floor, 17, 10],
    ["k-plane", kTrace.draw, kTrace.view, 24, 16],
];
for (const [id, draw, view, letters, lines] of drawings) {
    const canvas = byId(id);
    frames.add(canvas, draw, () => views && [view(), screen.themeFor(canvas, letters, lines)]);
}
const { canvas: score, draw: drawScore, view: scoreView } = kicks.verdict;
frames.add(score, drawScore, () => [scoreView(), screen.themeFor(score, 22, 6)]);

window.lab = { state: () => snapshot(lab, stop, frames, views, kTrace) };
source.open();
