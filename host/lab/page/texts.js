/** All words of the page. */

import { capital, counted, number, sentences } from "./words.js";

const VERBS = { reverses: "reverse", continues: "continue", stops: "stop" };
const DONE = { reverses: "reversed", continues: "continued", stops: "stopped" };
// The same of a wheel that rested before the kick.
const VERBS_AT_REST = { reverses: "begin to roll", continues: "stay at rest" };
const DONE_AT_REST = { reverses: "began to roll", continues: "stayed at rest" };
export const atRest = (before, side) => (before?.[side] === "stopped" ? DONE_AT_REST : DONE);
const likeliest = (shares) =>
    Object.entries(shares ?? {}).reduce(
        (best, entry) => (entry[1] > best[1] ? entry : best),
        ["", -1],
    );
const UNITS = { 1: "", "%": " %" };

export const texts = {
    title: "Kick control lab",
    skip: "Skip to the kicks",
    robots: "Robots",
    stopButton: "STOP",
    stopKey: "Esc or Space",
    stopLabel: "Stop all robots",
    projector: "Projector",
    projectorLabel: "Large text for a projector",
    sound: "Sound",
    soundLabel: "Sound: wheels tick as they turn, and the torque is a tone",

    wheels: "Wheels",
    key: {
        target: "target",
        actual: "actual",
        seen: "seen in a kick",
        force: "force",
        memory: "memory",
    },
    keyHints: {
        force:
            "The arrow is F_tan with the sign of the paper: positive drives the wheel forward." +
            " Springs drawn like these would pull the pin just as hard, but the other way.",
    },
    handNote: "Drag one to pull it by hand, or hold an arrow key on it.",
    strips: "The last seconds",
    planes: "Phase planes",
    lagPlane: "Lag and speed of both wheels",
    phiPlane: "Angle and speed",
    xPlane: "Memory",
    sliceNote: "a slice",
    lagNote:
        "Each plane is a slice of four dimensions: angle, speed, x₁ and x₂. Lag is how far the" +
        " angle that the neurons remember lies behind the wheel. A membrane kick makes it jump by" +
        " half a turn.",
    basins: "Basins",
    basinsLabel: "Basins: where each start leads",
    ends: { forward: "forward", backward: "backward", rest: "rest", neither: "to and fro" },
    share: (part) => ` ${part < 0.005 ? "<1" : number(100 * part, 0)} %`,
    basinsOf: (shares) => `Of all starts in this slice, these parts lead to: ${shares.join(", ")}`,
    basinsSlice: ({ phi_rad, radius }) =>
        `Where a wheel by itself ends from each start: φ = ${number(phi_rad, 0)}, x₁ and x₂ on a` +
        ` circle of radius ${number(radius)}.`,
    computing: ({ a, tau_s, k }) => `For a = ${a}, τ = ${tau_s} s, k = ${k}: being computed …`,
    noBasins: (why) => `No basins: ${why}.`,
    floor: "Path on the floor",
    floorNote: "From the turns of the wheels since the lab began. A wheel that slips misleads it.",

    kicks: "Kick",
    guess: "My guess: the wheels will …",
    guesses: { reverses: "Reverse", continues: "Continue", stops: "Stop", none: "No guess" },
    whichWheel: "Wheels",
    wheelChoices: { both: "Both", left: "Left", right: "Right" },
    theThree: {
        membrane: ["Membrane kick", "1 tick", "flips what the neurons remember"],
        position: ["Position kick", "3 ticks", "shows the neurons the opposite side"],
        phase: ["Phase kick", "4 ticks", "shows them the wheel 3/4 π further on"],
    },
    askSimulation: "What does the simulation expect?",
    ownKick: "Design your own kick",
    ownKickDo: "Kick like this",
    kind: "Kind of kick",
    kinds: {
        membrane: "Membrane",
        position: "Position",
        phase: "Phase",
        pulse: "Pulse",
        jump: "Jump",
    },
    ticks: "Length in ticks",
    ticksHint: (seconds) => `${number(seconds, 2)} s`,
    ticksWrong: "a whole number from 1 to 10000",
    shift: "Phase shift",
    shiftValue: (turns) => `${number(turns, 2)} π = ${number(turns * Math.PI, 2)} rad`,
    shiftSign: "Sign of the shift",
    shiftSigns: { auto: "The one that reverses", given: "As set" },
    shape: "Shape",
    shapes: { rectangular: "Rectangular", smooth: "Smooth" },
    pulsed: "What is pulsed",
    pulsedNames: { a: "a", tau_s: "τ", k: "k", beta: "beta", shift_rad: "shift" },
    pulseValue: (unit) => `Value at its height${unit ? ` (${unit})` : ""}`,
    variable: "What jumps",
    variables: { x1: "x₁", x2: "x₂" },
    delta: "By how much",

    lastKick: (kick) => `Last: ${texts.kickLine(kick)}`,
    startFirst: "The robot does not run. Start it to kick it.",
    noKick: "Nobody has kicked this robot yet.",
    kickLine: ({ mode, ticks }) =>
        mode
            ? `${texts.kinds[mode] ?? mode} kick, ${counted(ticks ?? 1, "tick", "ticks")}`
            : "A kick",
    sides: { left: "Left", right: "Right" },
    verdict: ({ name, shares, outcome, rested }, of) => {
        const [verbs, done] = rested ? [VERBS_AT_REST, DONE_AT_REST] : [VERBS, DONE];
        const [result, count] = likeliest(shares);
        if (!outcome) return result ? `${name}: ${count} of ${of} will ${verbs[result]}.` : name;
        const did = `${name} ${done[outcome]}`;
        if (!result) return `${did}.`;
        return outcome === result
            ? `${did}, as ${count} of ${of} predicted.`
            : `${did}, but ${count} of ${of} said: ${verbs[result]}.`;
    },
    expected: ({ shares, of }, wheel) => {
        const kicked = wheel === "both" ? Object.values(shares) : [shares[wheel]];
        const results = kicked.map(likeliest);
        const [[result]] = results;
        if (results.some(([other]) => other !== result)) return "they differ";
        return `${Math.min(...results.map(([, count]) => count))}/${of} ${VERBS[result]}`;
    },
    asExpected: "is what the simulation expects now",
    noOutcome: (why) => `No outcome: ${why}.`,
    unknown: "–",
    ownGuess: (guess, right) =>
        `Guess: ${VERBS[guess]}. ${right === null ? "" : right ? "Correct." : "Not this time."}`,
    score: ({ guesses, right, predicted, simulation }) =>
        sentences(
            guesses && `correct so far: you ${right} of ${guesses}`,
            predicted && `the simulation ${simulation} of ${predicted}`,
        ),
    ifNow: (kick) => `Now, a ${texts.kickLine(kick).toLowerCase()} would:`,

    moves: "Movements",
    primitives: "Motion primitives",
    presets: "Settings of the paper",
    moveNote: "A primitive takes a few kicks, and some seconds.",
    notReached: (name) => ({ message: `the robot did not reach '${name}'`, hint: "try it again" }),
    moving: "The robot is on its way …",
    parameters: "Parameters",
    parametersNote: "A change holds from the next tick on.",
    more: "More parameters",
    paramDoc: ({ doc, minimum, maximum, unit, default: usual }) =>
        `${capital(doc)}. ${minimum} to ${maximum}${UNITS[unit] ?? ` ${unit}`}, usually ${usual}.`,
    unit: (unit) => (unit === "1" || !unit ? "" : unit),
    notANumber: (name) => ({ message: `${name} needs a number`, hint: "write a point: 2.5" }),

    kTrace: "k up and down",
    kTraceNote:
        "Raise k, lower it again, and hold each value for some seconds: its mark is the mean of" +
        " the last one. A wheel that has begun to turn may go on below the k at which it began.",
    kTraceAlt: "Speed and |M| of both wheels at each k that was held",
    kTraceHold: ({ k, up, means: { left, right } }) =>
        `at k = ${number(k)}${up === null ? "" : up ? ", raised" : ", lowered"}: left` +
        ` ${number(left.omega_rad_s, 1)} rad/s, |M| ${number(left.torque)}; right` +
        ` ${number(right.omega_rad_s, 1)} rad/s, |M| ${number(right.torque)}`,
    kTraceLabels: { up: "raised", down: "lowered", left: "left", right: "right" },
    kTraceClear: "Clear the trace",

    state: "State",
    states: {
        idle: "Ready",
        running: "Running",
        held: "Held",
        stopped: "Stopped",
        fault: "Fault",
        lost: "Lost",
        "": "…",
    },
    remedies: { start: "Start", clear: "Clear the fault" },
    startsAfterPrediction: "It stands until you lock your prediction.",
    staysStill: "In this exercise its motors stay off.",
    lostFor: (seconds) =>
        `No word from the robot for ${number(seconds, 0)} s. The page looks for it.`,
    facts: {
        label: "Robot",
        address: "Address",
        motor: "Motors",
        battery: "Battery",
        punctual: "Ticks",
        driver: "Controlled by",
        reason: "Why it does not run",
        unattended: "If the driver's page closes",
        missed: "Records this page missed",
    },
    robotLabel: (name, label) => (name === label ? name : `${name}, ${label}`),
    volts: (volts) => `${number(volts, 2)} V`,
    punctual: ({ late = 0, missed = 0, overrun = 0 }) =>
        late + missed + overrun === 0
            ? "all on time"
            : `${late} late, ${missed} missed, ${overrun} too long`,
    unattended: { stop: "the robot stops", continue: "the robot goes on" },
    nobody: "nobody",
    identify: "Which one is it?",
    identified: { message: "The robot shows itself for 3 s.", hint: "" },

    recording: "Recording",
    recordOn: "Record",
    recordOff: "End the recording",
    recordingNow: (name) => `Recording to ${name}`,
    logs: "Logs to download",
    noLogs: "This lab has recorded no log yet.",
    download: (name, whole, failed) =>
        name + (failed ? " (ends early: not written in full)" : whole ? "" : " (still growing)"),
    replay: "Replay",
    replayLabel: (name) => `Replay ${name} in a new tab`,
    downloadFailed: (why) => ({ message: `the log did not come: ${why}`, hint: "try again" }),

    takeOver: (host) => `Take over from ${host}`,
    driving: "Who drives",
    youDrive: "This page drives.",
    youMay: "Nobody drives. Your first command takes the baton.",
    pageDrives: (page) => `Page ${page} drives. This page watches.`,
    driverUnknown: "No link to the lab: this page does not know who drives.",
    nobodyDrives: "Nobody drives. This page watches.",
    pages: (page, { driving, watching }) =>
        `This is page ${page}. ` +
        (driving ? "One page drives, " : "No page drives, ") +
        `${counted(watching, "watches", "watch")}.`,
    ask: "Ask to drive",
    asked: (page) =>
        `You have asked to drive, as page ${page}. A page with the drive address can say yes.`,
    take: "Drive from here",
    leave: "Drive no more",
    give: (page) => `Let page ${page} drive`,
    asks: (pages) =>
        `${pages.length > 1 ? `Pages ${pages.join(", ")} ask` : `Page ${pages[0]} asks`} to drive.`,

    stop: {
        sent: "STOP is on its way …",
        confirmed: "Stopped. The robot confirms it.",
        unconfirmed: "NOT confirmed. Look at the wheels: lift the robot, or press its back button.",
        waiting:
            "No link to the lab: STOP leaves as soon as it is back. Lift the robot, or press its" +
            " back button.",
    },

    connecting: "Connecting to the lab …",
    noLab: (seconds) =>
        `No link to the lab for ${number(seconds, 0)} s. What you see is old. The page tries` +
        ` again by itself; if this lasts, look whether ‘kickctl lab’ still runs.`,
    notConnected: { message: "there is no link to the lab", hint: "wait until it is back" },
    answerLost: {
        message: "the link to the lab broke before the answer came",
        hint: "look at the robot, and try again",
    },
    refused: "The lab did not let this page in",
    again: "Try again",
    close: "Close",

    delay: (milliseconds) => `shown ${number(milliseconds, 0)} ms late, to run evenly`,
    keys: "Esc stops all robots, anywhere. Space, too, unless you came to a control by keyboard.",
    wheelLabel: (side, { omega_rad_s, torque } = {}) =>
        `${texts.sides[side]} wheel: ${number(omega_rad_s / (2 * Math.PI), 1)} turns per second,` +
        ` M ${number(torque, 2)}`,

    wheelLabels: {
        forward: "forward",
        backward: "backward",
        rest: "at rest",
        duty: "duty",
        turns: "turns/s",
        stall: "stalls",
    },
    stripLabels: { left: "left", right: "right", stall: "stalls", period: "control period" },
    floorLabels: { start: "start" },
    scoreLabels: {
        reverses: "reverses",
        continues: "continues",
        stops: "stops",
    },

    reason: ({ reason, stopped_by: by = null }, page) => {
        if (by === null) return reason;
        if (by === 0) return "the lab stopped it, since nobody attended to it";
        return by === page ? "this page stopped it" : `another page of this lab (${by}) stopped it`;
    },
    said: {
        kick: (kick) => `Kick: ${texts.kickLine(kick)}.`,
        outcome: ({ result, before, why }) =>
            why
                ? texts.noOutcome(why)
                : `${Object.entries(result)
                      .map(([side, word]) => [texts.sides[side], atRest(before, side)[word]])
                      .map(([side, word], n) => `${n ? side.toLowerCase() : side} wheel ${word}`)
                      .join(", ")}.`,
        lost: (robot) => `${robot} does not answer.`,
        found: (robot) => `${robot} is back.`,
        fault: (robot, reason) => `${robot} is in fault: ${reason}.`,
        labLost: "The link to the lab is lost.",
        labFound: "The link to the lab is back.",
    },
};
