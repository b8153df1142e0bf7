/** The form for a kick of one's own. */

import { button, choices, element, numberField, options, show } from "./dom.js";
import { texts } from "./texts.js";

const USUAL_TICKS = { position: 3, phase: 4, pulse: 4 };
const ALWAYS_ONE_TICK = ["membrane", "jump"];
const USUAL_VALUE = { beta: 1, shift_rad: 2.36 };
// Of what is no parameter of the robot.
const LIMITS = { beta: [-1, 1], shift_rad: [-6.28, 6.28] };

/**
 * @param {import("./lab.js").Lab} lab
 * @param {(kick: object) => void} kick Does a kick.
 * @param {(kick: object) => void} predict Asks the simulation about one.
 */
export function createDesigner(lab, kick, predict) {
    const mode = choices("mode", texts.kind, options(texts.kinds), "phase", (chosen) => {
        if (chosen in USUAL_TICKS) ticks.input.value = USUAL_TICKS[chosen];
        arrange();
    });
    const ticks = numberField("kick-ticks", texts.ticks, { min: 1, max: 10000, step: 1, value: 4 });
    const sign = choices("shift-sign", texts.shiftSign, options(texts.shiftSigns), "auto", arrange);
    const shift = numberField("kick-shift", texts.shift, {
        type: "range",
        min: -2,
        max: 2,
        step: 0.05,
        value: 0.75,
    });
    const shape = choices("shape", texts.shape, options(texts.shapes), "rectangular");
    const param = choices("pulsed", texts.pulsed, options(texts.pulsedNames), "k", () => {
        const params = lab.store.robot?.status.params ?? {};
        value.input.value = USUAL_VALUE[param.value] ?? params[param.value] ?? 0;
        arrange();
    });
    const value = numberField("pulse-value", texts.pulseValue(""), { step: "any", value: 0 });
    const variable = choices("variable", texts.variable, options(texts.variables), "x1");
    const delta = numberField("jump-delta", texts.delta, { min: -2, max: 2, step: 0.1, value: 1 });

    const fields = () => {
        const made = { mode: mode.value };
        if (!ALWAYS_ONE_TICK.includes(made.mode)) {
            made.ticks = Number(ticks.input.value);
            made.shape = shape.value;
        }
        if (made.mode === "phase" && sign.value === "given") {
            made.shift = Number(shift.input.value) * Math.PI;
        }
        if (made.mode === "pulse") {
            made.param = param.value;
            made.value = Number(value.input.value);
        }
        if (made.mode === "jump") {
            made.variable = variable.value;
            made.delta = Number(delta.input.value);
        }
        return made;
    };

    const commands = element(
        "fieldset",
        { className: "bare" },
        button(texts.ownKickDo, () => sound() && kick(fields()), "kick own"),
    );
    const form = element("div", { className: "own-form" });
    form.append(mode, ticks.root, param, value.root, sign, shift.root, variable, delta.root, shape);
    const ask = button(texts.askSimulation, () => sound() && predict(fields()), "quiet asks");
    form.append(commands, ask);
    const root = element(
        "details",
        { className: "own" },
        element("summary", {}, texts.ownKick),
        form,
    );

    // The browser says what is wrong with a number.
    const sound = () =>
        [...form.querySelectorAll("input")].every(
            (input) => input.offsetParent === null || input.reportValidity(),
        );

    function arrange() {
        const is = mode.value;
        show(ticks.root, !ALWAYS_ONE_TICK.includes(is));
        show(shape, !ALWAYS_ONE_TICK.includes(is));
        show(sign, is === "phase");
        show(shift.root, is === "phase" && sign.value === "given");
        show(param, is === "pulse");
        show(value.root, is === "pulse");
        show(variable, is === "jump");
        show(delta.root, is === "jump");
        const row = lab.store.robot?.info.params.find(({ name }) => name === param.value);
        const unit = param.value === "shift_rad" ? "rad" : texts.unit(row?.unit);
        value.label.textContent = texts.pulseValue(unit);
        tell();
    }

    function tell() {
        const tick_s = lab.store.robot?.tick_s ?? 0;
        const { valid } = ticks.input.validity;
        const lasts = texts.ticksHint(Number(ticks.input.value) * tick_s);
        ticks.output.textContent = valid ? lasts : texts.ticksWrong;
        const accepted = LIMITS[param.value] ?? lab.store.robot?.status.accepts?.[param.value];
        const [min, max] = accepted ?? ["", ""];
        Object.assign(value.input, { min, max });
        shift.output.textContent = texts.shiftValue(Number(shift.input.value));
    }

    ticks.input.oninput = shift.input.oninput = tell;
    arrange();
    const update = () => {
        // Who asks the simulation first predicts nothing.
        ask.disabled = lab.store.held;
        tell();
    };
    return { root, commands, update };
}
