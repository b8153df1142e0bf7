/** The words of the class: the invitation, the question before a kick, and the answers. */

import { texts } from "./texts.js";
import { counted, sentences } from "./words.js";

const SAY = { reverses: "Reverse", continues: "Continue", stops: "Stop" };

export const classTexts = {
    button: "Class",
    buttonLabel: "Class: invite others, and ask them what a kick will do",
    title: "Class",
    invite: "Show the address",
    hide: "Hide the address",
    qrLabel: "QR code of the address for watching",
    inviteNote:
        "Who opens this address watches, answers, and may stop the robots. Nobody drives from" +
        " there unless you hand over the baton under ‘Who drives’.",
    inviteLocal:
        "Only this computer can open it. End the lab and start it by: kickctl lab --class",
    ask: "Ask the class what this kick will do:",
    kicks: { membrane: "Membrane kick", position: "Position kick", phase: "Phase kick" },
    wheels: { both: "both wheels", left: "the left wheel", right: "the right wheel" },
    question: ({ kick, robot }, several) =>
        `${several ? `${robot}: ` : ""}What will the wheels do after a` +
        ` ${texts.kickLine(kick).toLowerCase()}, of ${classTexts.wheels[kick.wheel ?? "both"]}?`,
    answer: "My answer",
    answers: SAY,
    waiting: ({ answered, of }) =>
        `${answered} of ${counted(of, "page has", "pages have")} answered. The answers show when` +
        " the kick runs; you can change yours until then.",
    row: (guess, count, of) => `${count} of ${of} say: ${SAY[guess].toLowerCase()}`,
    right: "✓ right",
    runs: "The kick runs. The answers hold.",
    nobody: "Nobody answered.",
    yours: (guess, state, right) =>
        guess &&
        sentences(
            `your answer: ${SAY[guess].toLowerCase()}`,
            state === "done" && (right.includes(guess) ? "correct" : "not this time"),
        ),
    outcome: (outcome) => texts.said.outcome(outcome),
    score: ({ kicks, majority, answers, right }) =>
        kicks
            ? `The class so far: ${right} of ${counted(answers, "answer", "answers")} right; the` +
              ` majority in ${majority} of ${counted(kicks, "kick", "kicks")}.`
            : "",
    kickNow: "Kick now",
    withdraw: "End the question",
};
