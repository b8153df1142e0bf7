/** The words of a replay that the live page has not. */

import { capital, counted, number, sentences } from "./words.js";
import { texts } from "./texts.js";

const wheelsOf = ({ wheels = [] }) =>
    wheels.length === 1 ? `${texts.sides[wheels[0]].toLowerCase()} wheel` : "both wheels";
const why = (name) => (event) => name + (event.reason ? `: ${event.reason}` : "");
const sameResults = ({ robot, twin }) =>
    Object.entries(robot).every(([side, result]) => twin[side] === result);
const listed = (results) =>
    Object.entries(results)
        .map(([side, result]) => `${texts.sides[side].toLowerCase()} ${result}`)
        .join(", ");
const FACTS = {
    brick: "Robot",
    started_utc: "Connected (UTC)",
    robot_software: "Release",
    seed: "Random seed",
    battery_v: "Battery (V)",
    motor: "Motors",
    twin: "Motors of the twin",
};

export const words = {
    ...texts,
    title: "Kick control replay",
    skip: "Skip to the time slider",
    loading: "Reading the log …",
    failed: (message) => sentences("The log cannot be shown", message),
    strips: "The seconds before",
    floorNote: "From the turns of the wheels since the log began. A wheel that slips misleads it.",

    twin: "Its simulated twin",
    twinStrips: "The twin's seconds before",
    twinKept: (kicks) => {
        const [same, total] = [kicks.filter(sameResults).length, kicks.length];
        return total
            ? `The simulated twin did the same after ${same} of ${counted(total, "kick", "kicks")}.`
            : "No kick was left alone for a second, to compare the simulated twin.";
    },
    beside: (said, kick) =>
        `${said}; twin: ${sameResults(kick) ? "the same" : listed(kick.twin)}` +
        (sameResults(kick) ? "" : `, robot: ${listed(kick.robot)}`),

    working: "The equations in this tick",
    workingNote:
        "xᵃ: where a rod is. xˢ: where its neuron sees it, the same but for a kick. xᵗ: where" +
        " the neuron wants it. A position kick inverts what the neuron sees: β = 1. A phase" +
        " kick turns it by the angle δ. ←: the new value, from the old one. If rod_lag_s is" +
        " above 0, F uses an earlier position than xᵃ. ✓: the robot has logged the same bits." +
        " ≈: the same but for rounding.",
    fromTheLog: "from the log: ",
    digits: "All digits",
    digitsLabel: "All digits of each number, as exact as the log",
    quantity: "Quantity",
    workingLabel: "Equations of both wheels with the numbers of this tick",
    at: ({ tick, since_s, dt_s }) =>
        `Tick ${tick}, ${number(since_s, 2)} s, Δt = ${number(1000 * dt_s, 1)} ms`,
    compared: [
        "Not compared: the log does not say what the potentials were before this tick.",
        "The robot's program computes the same bits from the logged angles.",
        "As logged but for rounding: the robot's machine has other mathematical functions.",
        "The robot's program computes something else than the log says.",
    ],
    off: "The motors are off in this tick: no equation acts, and the potentials stay.",
    asLogged: "✓",
    nearlyLogged: "≈",
    notLogged: (value) => `✗ logged: ${value}`,

    play: "Play",
    pause: "Pause",
    back: "One tick back",
    forth: "One tick on",
    former: "What happened before",
    next: "What happened next",
    speed: "Speed",
    speeds: { 0.1: "1/10", 0.25: "1/4", 1: "1", 4: "4", 16: "16" },
    slider: "Time",
    sliderText: (tick, since_s, total_s) =>
        `tick ${tick}, ${number(since_s, 2)} s of ${number(total_s, 2)} s`,
    time: (since_s, total_s) => `${number(since_s, 2)} / ${number(total_s, 2)} s`,
    keys:
        "← and → go a tick, with Shift a second, Home and End to the ends; Space plays and" +
        " pauses; , and . go to what happened before and next.",
    happened: "What happened",
    nothingHappened: "No kick, no stop, no fault.",
    happenedAt: (since_s, said) => `${number(since_s, 2)} s  ${capital(said)}`,
    marks: {
        kick: "kick",
        fault: "fault",
        stop: "stop",
        missing: "ticks missing",
        differs: "not as computed",
    },
    about: "About this log",
    facts: { ...FACTS, log: "Log", part: "Part", params: "Parameters in this tick" },

    verdict: ({ compared, exact, reproduced, worst, not_comparable: left, missing }) => {
        const ticks = counted(compared, "tick", "ticks");
        const found = !compared
            ? "no tick could be compared"
            : exact
              ? `${ticks} recomputed, bit for bit as logged`
              : reproduced
                ? `${ticks} recomputed, as logged within ${worst.toExponential(0)}`
                : `this log does NOT match the robot's program (${ticks} recomputed)`;
        return sentences(
            found,
            left && `${counted(left, "tick", "ticks")} not comparable`,
            missing && `${counted(missing, "tick is", "ticks are")} missing`,
        );
    },
    // No sentence begins with the log's path or with the command: both are written as they are.
    damage: (damage) =>
        `Not all of this log can be read: ${damage}. More is read by ‘kickctl log recover LOG’,` +
        " with this log's path for LOG: also what is whole behind the damage.",
    events: {
        kick: ({ kick }) => `${texts.kickLine(kick)}, ${wheelsOf(kick)}`,
        start: () => "start",
        stop: why("stop"),
        hold: why("held"),
        resume: () => "goes on",
        fault: why("fault"),
        clear: () => "the fault is cleared",
        take_over: why("another host drives"),
        link_loss: why("link lost"),
        battery: why("battery"),
        restart: () => "the robot's program began again: its ticks count from 0",
        lost: () => "ticks are missing here",
        params: ({ set }) => {
            const values = Object.entries(set).map(([name, value]) => `${name} = ${value}`);
            return `${values.length === 1 ? "parameter" : "parameters"} ${values.join(", ")}`;
        },
    },
    otherEvent: ({ event }) => event,
    missing: (ticks) => counted(ticks, "tick is missing here", "ticks are missing here"),
    missed: (periods) =>
        `${counted(periods, "control period", "control periods")} without a tick before this one`,
    differs: "the log is not what the robot's program computes",
};
