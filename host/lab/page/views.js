/** What each drawing shows: views of what is known of a robot at the time that is on the screen. */

import { texts } from "./texts.js";

const SECONDS = 8;
const TRACE_S = 5;
const FLOOR_RECORDS = 4000;
const TURN = 2 * Math.PI;
const KICK_NAMES = ["", ...Object.keys(texts.kinds)];
const SIDES = ["left", "right"];
const SIDE_COLOURS = { left: "left1", right: "right1" };

/** The views of one robot. Each frame fills the same objects again. */
export class Views {
    #fastest = 3;
    #view = {};

    /** @param {import("./robot_view.js").RobotView} robot */
    constructor(robot) {
        this.robot = robot;
        this.wheels = {};
        for (const side of SIDES) {
            const title = texts.sides[side];
            this.wheels[side] = { title, labels: texts.wheelLabels, stall: robot.info.stall };
        }
        this.strips = {
            columns: robot.ring.columns,
            seconds: SECONDS,
            stall: robot.info.stall,
            labels: texts.stripLabels,
        };
        const { walls, track_m } = robot.info;
        const floorLabels = texts.floorLabels;
        this.floor = { walls, track_m, view: this.#view, labels: floorLabels };
        this.#makeTraces();
    }

    /**
     * Move all views to what is on the screen now.
     * @param {number} now_s The page's clock, s.
     * @returns {boolean} Whether time has passed on the screen.
     */
    update(now_s) {
        const { ring, playout } = this.robot;
        const before = this.time;
        this.time = playout.time(now_s, ring.newest("t_s"));
        this.age = 0;
        const t = ring.columns.t_s;
        while (this.age + 1 < ring.length && t[ring.place(this.age)] > this.time) this.age += 1;
        this.stale = this.robot.lost || !this.linked;
        for (const side of SIDES) this.#turn(side);
        this.#show();
        return !Object.is(this.time, before);
    }

    /** @param {string} side @returns {number} The angle of a wheel on the screen, rad. */
    angle(side) {
        const { ring } = this.robot;
        const [phi, t] = [ring.columns[`${side}_phi_rad`], ring.columns.t_s];
        const [now, next] = [ring.place(this.age), ring.place(Math.max(0, this.age - 1))];
        const span = t[next] - t[now];
        const part = span > 0 ? Math.max(0, Math.min(1, (this.time - t[now]) / span)) : 0;
        return phi[now] + part * (phi[next] - phi[now]);
    }

    #turn(side) {
        const { ring } = this.robot;
        const state = this.wheels[side];
        const place = ring.place(this.age);
        const known = ring.length > 0;
        const value = (name) => (known ? ring.columns[`${side}_${name}`][place] : NaN);
        state.phi_rad = known ? this.angle(side) : NaN;
        for (const name of WHEEL_CHANNELS) state[name] = value(name);
        // Between two records the seen positions turn on with the wheel.
        const turned = state.phi_rad - value("phi_rad");
        const [cos, sin] = [Math.cos(turned), Math.sin(turned)];
        const { seen1, seen2 } = state;
        state.seen1 = seen1 * cos - seen2 * sin;
        state.seen2 = seen1 * sin + seen2 * cos;
        state.kick = this.#kickOn(side, place);
        state.stale = this.stale;
    }

    /** The name of the kick that acts on a wheel, empty if none does. */
    #kickOn(side, place) {
        const { ring, kicks } = this.robot;
        const mode = KICK_NAMES[ring.columns.kick[place]];
        if (!mode || !ring.length) return "";
        const tick = ring.columns.tick[place];
        const kick = kicks.findLast(({ begin }) => begin <= tick);
        return kick?.wheels?.includes(side) === false ? "" : texts.kinds[mode];
    }

    #show() {
        const { robot, strips, floor } = this;
        const { ring } = robot;
        const behind = ring.place(this.age) + 1;
        const length = ring.length - this.age;
        const count = Math.min(length, Math.ceil(TRACE_S / robot.tick_s));
        const start = (behind - count + ring.capacity) % ring.capacity;
        for (const side of SIDES) this.#ghost(side);
        for (const plane of [this.lag, this.phi, this.x]) {
            Object.assign(plane, { start, count, stale: this.stale });
        }
        this.lag.basins = robot.basins;
        const fastest = Math.max(
            ...SIDES.map((side) => Math.abs(this.wheels[side].omega_rad_s) || 0),
        );
        this.#fastest = Math.max(this.#fastest, Math.ceil(fastest / TURN));
        for (const plane of [this.lag, this.phi]) {
            [plane.y.minimum, plane.y.maximum] = [-this.#fastest, this.#fastest];
        }
        const first = (behind - length + ring.capacity) % ring.capacity;
        Object.assign(strips, {
            start: first,
            count: length,
            now_s: this.time,
            tick_s: robot.tick_s,
            kicks: robot.kicks.filter((kick) => kick.begin_s > this.time - SECONDS - 1),
            stale: this.stale,
        });
        for (const kick of strips.kicks) kick.name ??= texts.kinds[kick.mode] ?? "";
        const path = Math.min(length, FLOOR_RECORDS);
        const { x_m, y_m, heading_rad } = ring.columns;
        const begin = (behind - path + ring.capacity) % ring.capacity;
        Object.assign(floor, { x_m, y_m, heading_rad, start: begin, count: path });
        floor.stale = this.stale;
    }

    /** Where a quenched kick lets a wheel seem to be. */
    #ghost(side) {
        const { phi_rad, seen1, seen2, kick, omega_rad_s } = this.wheels[side];
        const index = SIDES.indexOf(side);
        const apart = Math.hypot(seen1 - Math.cos(phi_rad), seen2 - Math.sin(phi_rad));
        const y = omega_rad_s / TURN;
        const seen = Math.atan2(seen2, seen1);
        const { ring } = this.robot;
        const lag = ring.length ? ring.columns[`${side}_lag_rad`][ring.place(this.age)] : NaN;
        const ghost = kick && apart > 0.5;
        this.phi.traces[index].ghost = ghost ? { x: seen, y } : null;
        this.lag.traces[index].ghost = ghost ? { x: lag + seen - phi_rad, y } : null;
    }

    #makeTraces() {
        const { columns } = this.robot.ring;
        const trace = (x, y, scale_y) =>
            SIDES.map((side) => ({
                x: columns[`${side}_${x}`],
                y: columns[`${side}_${y}`],
                scale_y,
                jumped: this.robot.jumped[side],
                colour: SIDE_COLOURS[side],
                dashed: side === "right",
                name: texts.stripLabels[side],
                ghost: null,
            }));
        const turns = () => ({ symbol: "ω/2π", unit: "1/s", minimum: -3, maximum: 3 });
        const angle = { minimum: -Math.PI, maximum: Math.PI, pi: true, wrap: true, unit: "rad" };
        this.lag = {
            note: texts.sliceNote,
            x: { ...angle, symbol: "lag" },
            y: turns(),
            traces: trace("lag_rad", "omega_rad_s", 1 / TURN),
        };
        this.phi = {
            note: texts.sliceNote,
            x: { ...angle, symbol: "φ" },
            y: turns(),
            traces: trace("phi_rad", "omega_rad_s", 1 / TURN),
        };
        const potential = { minimum: -1.2, maximum: 1.2, unit: "" };
        this.x = {
            note: texts.sliceNote,
            x: { ...potential, symbol: "x₁" },
            y: { ...potential, symbol: "x₂" },
            traces: trace("x1", "x2", 1),
            equal: true,
        };
    }
}

const WHEEL_CHANNELS = [
    "x1",
    "x2",
    "target1",
    "target2",
    "seen1",
    "seen2",
    "force",
    "torque",
    "omega_rad_s",
    "duty_pct",
];
