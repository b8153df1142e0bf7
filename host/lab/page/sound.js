/** The robot as one hears it: each wheel ticks as it turns, and its torque is a tone. */

import { AT_REST } from "./robot_view.js";

// A wheel ticks this many times a turn.
const CLICKS_A_TURN = 8;
// The tone without torque (Hz), and how many octaves full torque lies above or below it.
const MIDDLE_HZ = 220;
const OCTAVES = 1;
const TONE_GAIN = 0.05;
const CLICK_GAIN = 0.3;
const CLICK_S = 0.02;
// How fast a tone follows (s).
const GLIDE_S = 0.03;
const PLACES = { left: -0.8, right: 0.8 };

export class Sound {
    #context = null;
    #voices = {};
    #on = false;
    #ticks = 0;

    /** @param {HTMLButtonElement} button Switches it on and off; off at first. */
    constructor(button) {
        button.onclick = () => {
            this.#on = !this.#on;
            button.setAttribute("aria-pressed", String(this.#on));
            this.#breathe();
        };
        // A hidden page draws no frames: its last tone would not end.
        document.addEventListener("visibilitychange", () => this.#breathe());
    }

    /**
     * Sound as the wheels on the screen do.
     * @param {import("./views.js").Views} views
     */
    update(views) {
        if (!this.#on) return;
        const silent = views.stale || AT_REST.includes(views.robot.state);
        for (const [side, voice] of Object.entries(this.#voices)) {
            const { phi_rad, torque } = views.wheels[side];
            const place = Math.floor((phi_rad / (2 * Math.PI)) * CLICKS_A_TURN);
            if (!silent && ![null, place].includes(voice.place)) this.#tick(voice);
            voice.place = place;
            const now = this.#context.currentTime;
            const pitch = MIDDLE_HZ * 2 ** (OCTAVES * (silent ? 0 : torque || 0));
            voice.tone.frequency.setTargetAtTime(pitch, now, GLIDE_S);
            voice.gain.gain.setTargetAtTime(silent ? 0 : TONE_GAIN, now, GLIDE_S);
        }
    }

    /** @returns {{on: boolean, ticks: number, pitch_hz: object}} What is heard, for tests. */
    state() {
        const pitch_hz = {};
        for (const [side, { tone }] of Object.entries(this.#voices)) {
            pitch_hz[side] = tone.frequency.value;
        }
        return { on: this.#on, ticks: this.#ticks, pitch_hz };
    }

    #breathe() {
        if (this.#on && !this.#context) this.#begin();
        if (!this.#context) return;
        if (this.#on && !document.hidden) this.#context.resume();
        else this.#context.suspend();
    }

    #begin() {
        const context = (this.#context = new AudioContext());
        for (const [side, pan] of Object.entries(PLACES)) {
            const out = new StereoPannerNode(context, { pan });
            const tone = new OscillatorNode(context, { type: "triangle", frequency: MIDDLE_HZ });
            const gain = new GainNode(context, { gain: 0 });
            tone.connect(gain).connect(out).connect(context.destination);
            tone.start();
            this.#voices[side] = { tone, gain, out, place: null };
        }
    }

    #tick({ out }) {
        const context = this.#context;
        const now = context.currentTime;
        const tone = new OscillatorNode(context, { type: "square", frequency: 1800 });
        const gain = new GainNode(context, { gain: CLICK_GAIN });
        gain.gain.linearRampToValueAtTime(0, now + CLICK_S);
        tone.connect(gain).connect(out);
        tone.start(now);
        tone.stop(now + CLICK_S);
        this.#ticks += 1;
    }
}
