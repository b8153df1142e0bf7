/** One robot or twin among several: what it does, its wheels, its plane, and a STOP of its own. */

import { besideTexts } from "./beside_texts.js";
import { button, element, setText, show } from "./dom.js";
import { labelWheels } from "./drawings.js";
import { draw as drawPlane } from "./draw/plane.js";
import { draw as drawWheel } from "./draw/wheel.js";
import { onBasins } from "./ground.js";
import { Hand } from "./hand.js";
import { help, lostWords, remedyOf, shownState, stateWord, whyOf } from "./now.js";
import { texts } from "./texts.js";
import { fitted } from "./theme.js";
import { Views } from "./views.js";
import { sentences } from "./words.js";

const SIDES = ["left", "right"];

export class Card {
    #info = element("div", { className: "info" });
    #title = element("h2");
    #state = element("b", { className: "state" });
    #kind = element("span", { className: "kind" });
    #choose = button("", () => this.#select(), "choose");
    #remedy = button("", () => help(this.lab, this.robot), "remedy");
    #stop = button(texts.stopButton, () => {}, "stop");
    #said = element("p", { className: "card-said" });
    #note = element("p", { className: "card-note" });
    #is;
    #canvases = {};
    #hands;
    #select;
    #views = null;

    /**
     * @param {object} page Its `lab`, `stop`, `frames` and `screen`.
     * @param {(robot: import("./robot_view.js").RobotView) => void} select Has kicks go to a robot.
     */
    constructor({ lab, stop, frames, screen }, select) {
        Object.assign(this, { lab, stop, screen });
        /** @type {?import("./robot_view.js").RobotView} What it shows. */
        this.robot = null;
        this.root = element("section", { className: "card" });
        this.#select = () => this.robot && !this.twin && select(this.robot);
        stop.obey(this.#stop, () => this.robot?.name);
        const is = element("div", { className: "is" }, this.#state, this.#kind);
        const what = element("div", { className: "do" }, this.#choose, this.#remedy);
        this.#info.append(this.#title, is, this.#stop, what, this.#said, this.#note);
        this.#is = is;
        this.root.append(this.#info);
        this.root.onclick = (event) => event.target.closest("button") || this.#select();
        const drawings = [
            ["left", drawWheel, ({ wheels }) => wheels.left, 21, 19],
            ["right", drawWheel, ({ wheels }) => wheels.right, 21, 19],
            ["plane", onBasins(drawPlane), ({ lag }) => lag, 17, 10],
        ];
        for (const [name, draw, view, letters, lines] of drawings) {
            const canvas = element("canvas", { role: "img" });
            this.#canvases[name] = canvas;
            this.root.append(element("figure", { className: name }, canvas));
            // Of several drawings each is small, on a projector too; a plane bears its large text.
            const theme = () =>
                name === "plane"
                    ? screen.themeFor(canvas, letters, lines)
                    : fitted(screen.theme, canvas, letters, lines);
            frames.add(canvas, draw, () => this.#views && [view(this.#views), theme()]);
        }
        this.#hands = SIDES.map((side) => {
            const angle = () => this.#views.angle(side);
            const shown = () => (this.twin ? null : this.robot);
            return new Hand(this.#canvases[side], side, lab, screen, angle, shown);
        });
    }

    /** @returns {boolean} Whether it shows a twin. */
    get twin() {
        return Boolean(this.robot?.robot);
    }

    /** @param {import("./robot_view.js").RobotView} robot What it shows from now on. */
    take(robot) {
        if (this.robot === robot) return;
        this.robot = robot;
        this.#views = new Views(robot);
    }

    /**
     * Move all to what is on the screen now.
     * @param {number} now_s The page's clock, s.
     * @returns {boolean} Whether time has passed on the screen.
     */
    move(now_s) {
        this.#views.linked = this.lab.store.link.up;
        return this.#views.update(now_s);
    }

    /** Say what is known. */
    update() {
        const { robot, twin } = this;
        const { robots, targets, canDrive, mayDrive } = this.lab.store;
        const is = shownState(robot);
        const here = targets.includes(robot);
        this.#is.dataset.state = is;
        this.root.classList.toggle("here", here && robots.length > 1);
        this.root.classList.toggle("twin-card", twin);
        this.root.classList.toggle("stale", robot.lost);
        const name = twin ? besideTexts.twinOf(robot.robot.name) : robot.name;
        this.root.setAttribute("aria-label", name);
        setText(this.#title, name);
        setText(this.#state, twin && robot.lost ? besideTexts.paused : stateWord(robot));
        setText(this.#kind, twin ? besideTexts.twin : "");
        show(this.#choose, !twin && robots.length > 1);
        const { here: drives, choose, shown, look } = besideTexts;
        const words = canDrive ? (here ? drives : choose) : here ? shown : look;
        setText(this.#choose, words);
        this.#choose.setAttribute("aria-pressed", String(here));
        this.#choose.setAttribute("aria-label", besideTexts.chooseLabel(words, name));
        const helps = twin || robots.length === 1 ? null : remedyOf(robot, this.lab.store);
        show(this.#remedy, Boolean(helps));
        setText(this.#remedy, texts.remedies[helps] ?? "");
        const remedyLabel = besideTexts.remedy(texts.remedies[helps], name);
        this.#remedy.setAttribute("aria-label", remedyLabel);
        this.#remedy.disabled = !mayDrive;
        show(this.#stop, !twin);
        this.#stop.setAttribute("aria-label", besideTexts.stopLabel(name));
        const stopping = twin ? null : this.stop.progress()[robot.name];
        // What came after a stop counts more, as a fault.
        const over = stopping === "confirmed" && is !== "stopped";
        const said = twin ? this.#twinSaid() : this.#robotSaid(is);
        const ofStop = stopping && !over && this.stop.words(robot.name, stopping);
        setText(this.#said, ofStop || said);
        const unsure = ["unconfirmed", "waiting", "refused"].includes(stopping);
        this.#said.classList.toggle("alarm", unsure);
        setText(this.#note, twin ? besideTexts.notPushed(robot.robot.name) : "");
        this.#ground();
        for (const hand of this.#hands) hand.update();
        labelWheels(this.#views, (side) => this.#canvases[side], SIDES);
    }

    #robotSaid(is) {
        const { robot } = this;
        if (is === "lost") return lostWords(robot);
        if (is !== "running") return whyOf(robot, this.lab.store);
        const kick = robot.kicks.at(-1);
        return kick ? besideTexts.lastKick(kick, kick.outcome) : texts.noKick;
    }

    /** Say why a plane has no basins: a blank one among basins would mean that nothing lasts. */
    #ground() {
        const { robot, twin, lab } = this;
        const { plane } = this.#canvases;
        const why = (robot === lab.store.robot && robot.picture?.why) || "";
        let note = texts.sliceNote;
        if (lab.store.basins && !robot.basins) {
            if (twin) note = besideTexts.twinsPlane;
            else if (robot !== lab.store.robot) note = besideTexts.othersPlane;
            else note = why ? besideTexts.noBasins : besideTexts.computing;
        }
        plane.setAttribute("aria-label", sentences(texts.lagPlane, note));
        plane.title = why && texts.noBasins(why);
        // The large text of a projector leaves no room for more.
        this.#views.lag.note = this.screen.projector ? texts.sliceNote : note;
    }

    #twinSaid() {
        const { info, compared, score, robot } = this.robot;
        if (info.why) return besideTexts.noTwin(info.why, info.hint);
        const last = compared ? besideTexts.compared(compared, robot.name) : "";
        return `${last} ${besideTexts.score(score)}`.trim();
    }

    /** @returns {object} What it shows, for tests. */
    state() {
        const { robot, twin } = this;
        const { time = null, wheels, lag, stale } = this.#views ?? {};
        const [traced, note] = [lag?.count ?? 0, lag?.note];
        return { name: robot.name, twin, time, wheels, traced, note, stale };
    }
}
