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
// A torque that moves no wheel from rest has no tone; this one if nobody knows which it is.
const QUIET = 0.05;
// Frames and the clock of the sound come by jerks: clicks this late (s) are as even as the wheel.
const LATE_S = 0.04;
// How much of a change of the two clocks' difference counts in a frame, and a jump of it (s).
const DRIFT = 0.05;
const JUMP_S = 0.1;
// Who has not seen a robot for so long (s) does not hear what it did meanwhile.
const AWAY_S = 1;
const PLACES = { left: -0.8, right: 0.8 };

export class Sound {
    #context = null;
    #voices = {};
    #on = false;
    #ticks = 0;
    /** How far the sound's clock is ahead of the robot's, s. */
    #ahead = 0;

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
        const { robot, time } = views;
        const silent = views.stale || AT_REST.includes(robot.state);
        const now = this.#context.currentTime;
        const change = now - time - this.#ahead;
        this.#ahead += Math.abs(change) < JUMP_S ? DRIFT * change : change;
        for (const [side, voice] of Object.entries(this.#voices)) {
            const { phi_rad, torque } = views.wheels[side];
            const turned = (phi_rad / (2 * Math.PI)) * CLICKS_A_TURN;
            if (!silent) this.#clickUpTo(voice, turned, time);
            const pull = silent ? 0 : torque || 0;
            const pitch_hz = MIDDLE_HZ * 2 ** (OCTAVES * pull);
            const sounds = Math.abs(pull) > (robot.info.stall ?? QUIET);
            Object.assign(voice, { turned, time, pitch_hz, sounds });
            voice.tone.frequency.setTargetAtTime(pitch_hz, now, GLIDE_S);
            voice.gain.gain.setTargetAtTime(sounds ? TONE_GAIN : 0, now, GLIDE_S);
        }
    }

    /**
     * @returns {{on: boolean, ticks: number, pitch_hz: object, sounds: object}} What is heard, for
     *     tests; by wheel the tone's pitch, and whether it sounds.
     */
    state() {
        const [pitch_hz, sounds] = [{}, {}];
        for (const [side, voice] of Object.entries(this.#voices)) {
            pitch_hz[side] = voice.pitch_hz;
            sounds[side] = voice.sounds;
        }
        return { on: this.#on, ticks: this.#ticks, pitch_hz, sounds };
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
            this.#voices[side] = { tone, gain, out, turned: NaN, time: NaN };
        }
    }

    /** Click for each mark that a wheel has passed since the last frame, when it passed there. */
    #clickUpTo(voice, turned, time) {
        const [way, long_s] = [turned - voice.turned, time - voice.time];
        if (!(long_s >= 0 && long_s < AWAY_S)) return;
        const [low, high] = [Math.min(turned, voice.turned), Math.max(turned, voice.turned)];
        for (let mark = Math.floor(low) + 1; mark <= high; mark += 1) {
            const passed = voice.time + ((mark - voice.turned) / way) * long_s;
            this.#tick(voice, passed + this.#ahead + LATE_S);
        }
    }

    #tick({ out }, when) {
        const context = this.#context;
        const at = Math.max(when, context.currentTime);
        const tone = new OscillatorNode(context, { type: "square", frequency: 1800 });
        const gain = new GainNode(context, { gain: 0 });
        gain.gain.setValueAtTime(CLICK_GAIN, at);
        gain.gain.linearRampToValueAtTime(0, at + CLICK_S);
        tone.connect(gain).connect(out);
        tone.start(at);
        tone.stop(at + CLICK_S);
        this.#ticks += 1;
    }
}
