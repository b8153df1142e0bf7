/** The words around the guided exercises; their own texts come from the lab. */

export const lessonTexts = {
    button: "Exercises",
    buttonLabel: "Guided exercises: predict, try, check",
    title: "Guided exercises",
    intro: "Each one asks for a prediction first. Nothing moves before it is locked.",
    prediction: "I predict:",
    lock: "Lock my prediction",
    locked: (answer) => `Your prediction is locked: ${answer}.`,
    walls:
        "This exercise needs walls, and a floor on which the tyres do not spin. Ask your" +
        " teacher to end the lab, and to start it by:" +
        " kickctl --brick 'sim://?walls=2&axle=400&grip=1.83&bumper=0.25' lab",
    hint: "A hint",
    check: "Check what I did",
    checking: "The log is being checked. The first time this takes some seconds …",
    notYet: "Not yet. Go on; what you have done counts.",
    done: "Done.",
    right: (answer) => `You were right: ${answer}.`,
    wrong: (guess, answer) => `You predicted: ${guess}. It is: ${answer}.`,
    misconception: (words) => `What many people think at first: ‘${words}’`,
    ok: "✓",
    missing: "✗",
    next: "Next exercise",
    leave: "Leave the exercise",
};
