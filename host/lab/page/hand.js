/** The hand: pull a wheel of a simulated robot with the pointer, or with the arrow keys. */

import { layout } from "./draw/wheel.js";

const EVERY_MS = 50;
// How far an arrow key pulls, rad.
const KEY_PULL = 1;
// How far from the axle a wheel can be grasped, in radii.
const REACH = 1.2;

export class Hand {
    #target = null;
    #timer = 0;

    /**
     * @param {HTMLCanvasElement} canvas The drawing of the wheel.
     * @param {"left" | "right"} wheel
     * @param {import("./lab.js").Lab} lab
     * @param {import("./screen.js").Screen} screen Knows the theme of the drawing.
     * @param {() => number} angle The angle of the wheel on the screen, rad.
     * @param {() => ?import("./robot_view.js").RobotView} shown The robot whose wheel it is.
     */
    constructor(canvas, wheel, lab, screen, angle, shown = () => lab.store.robot) {
        Object.assign(this, { canvas, wheel, lab, screen, angle, shown });
        canvas.addEventListener("pointerdown", (event) => this.#grab(event));
        canvas.addEventListener("pointermove", (event) => this.#move(event));
        for (const end of ["pointerup", "pointercancel", "lostpointercapture", "blur", "keyup"]) {
            canvas.addEventListener(end, () => this.release());
        }
        canvas.addEventListener("keydown", (event) => this.#press(event));
        addEventListener("blur", () => this.release());
        document.addEventListener("visibilitychange", () => this.release());
    }

    /** @returns {boolean} Whether this page may pull the wheel now. */
    get allowed() {
        const robot = this.shown();
        return Boolean(robot?.info.hand && this.lab.store.mayDrive && !robot.lost);
    }

    /** Say by the canvas whether it can be pulled. */
    update() {
        this.canvas.classList.toggle("graspable", this.allowed);
        if (this.allowed) this.canvas.tabIndex = 0;
        else this.canvas.removeAttribute("tabindex");
        if (!this.allowed) this.release();
    }

    /** Let go. */
    release() {
        if (this.#target === null) return;
        this.#target = null;
        clearInterval(this.#timer);
        this.canvas.classList.remove("grasped");
        this.#send();
    }

    #grab(event) {
        const { angle, reach } = this.#pointed(event);
        if (!this.allowed || reach > REACH) return;
        event.preventDefault();
        this.canvas.setPointerCapture(event.pointerId);
        this.before = angle;
        this.#pull(this.angle());
    }

    #move(event) {
        if (this.#target === null || !this.canvas.hasPointerCapture(event.pointerId)) return;
        const { angle: at } = this.#pointed(event);
        const turned = Math.atan2(Math.sin(at - this.before), Math.cos(at - this.before));
        this.before = at;
        this.#target += turned;
    }

    #press(event) {
        const way = { ArrowUp: 1, ArrowLeft: 1, ArrowDown: -1, ArrowRight: -1 }[event.key];
        if (!way || !this.allowed) return;
        event.preventDefault();
        if (!event.repeat) this.#pull(this.angle() + way * KEY_PULL);
    }

    #pull(target) {
        const { baton } = this.lab.store;
        this.robot = this.shown().name;
        // Only who drives may pull; a free baton comes at once.
        if (!baton.you) this.lab.request({ type: "ask" }).catch((no) => this.lab.tell(no));
        this.#target = target;
        this.canvas.classList.add("grasped");
        clearInterval(this.#timer);
        this.#timer = setInterval(() => this.#send(), EVERY_MS);
        this.#send();
    }

    #send() {
        const { robot, wheel } = this;
        this.lab.send({ type: "hand", robot, wheel, angle_rad: this.#target });
    }

    /** Where the pointer is, seen from the axle: the angle, rad, and the distance, in radii. */
    #pointed(event) {
        const axle = layout(this.canvas, this.screen.theme);
        const box = this.canvas.getBoundingClientRect();
        const [right, up] = [event.clientX - box.left - axle.x, axle.y - event.clientY + box.top];
        return { angle: Math.atan2(up, right), reach: Math.hypot(right, up) / axle.radius };
    }
}
