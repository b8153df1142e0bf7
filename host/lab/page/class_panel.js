/** The class: how others come to the page, and what they expect of a kick. */

import { classTexts } from "./class_texts.js";
import { button, choices, element, options, setText, show } from "./dom.js";

/**
 * @param {HTMLElement} root
 * @param {HTMLButtonElement} opener Opens and closes the panel of the teacher.
 * @param {import("./lab.js").Lab} lab
 * @param {{usual: object[], wheel: () => string}} kicks The kicks to ask about, and their wheels.
 * @returns {() => void} Brings the panel up to date.
 */
export function createClass(root, opener, lab, kicks) {
    let open = false;
    let known = "";
    const send = (message) => lab.request(message).catch((no) => lab.tell(no));
    const poll = (kick) => send({ type: "poll", robot: lab.store.robot.name, kick });

    const invitation = createInvitation(lab);
    const asks = element("fieldset", { className: "buttons" });
    asks.append(element("legend", {}, classTexts.ask));
    for (const fields of kicks.usual) {
        const ask = () => poll({ ...fields, wheel: kicks.wheel() });
        asks.append(button(classTexts.kicks[fields.mode], ask));
    }

    const question = element("p", { className: "question", role: "status" });
    const say = (guess) =>
        lab.request({ type: "answer", guess }).catch((no) => {
            lab.tell(no);
            answers.choose(lab.store.poll.yours);
        });
    const answers = choices(
        "answer",
        classTexts.answer,
        options(classTexts.answers),
        null,
        say,
    );
    const words = element("p", { role: "status" });
    const bars = element("ul", { className: "bars" });
    const yours = element("p");
    const score = element("p", { className: "fine" });
    const kick = button(classTexts.kickNow, () => lab.try("kick", lab.store.poll.kick), "go");
    const end = button(classTexts.withdraw, () => poll(null), "quiet");
    const asked = element("div", { className: "asked" }, question, answers, words, bars, yours);
    const commands = element("div", { className: "buttons" }, kick, end);
    root.append(invitation.root, asks, asked, commands, score);

    root.setAttribute("aria-label", classTexts.title);
    setText(opener, classTexts.button);
    opener.setAttribute("aria-label", classTexts.buttonLabel);
    opener.onclick = () => {
        open = !open;
        lab.changed = true;
    };

    return () => {
        const { store } = lab;
        const { poll: now, baton, robot } = store;
        const [teaches, drives] = [store.role === "drive", baton.you || store.canDrive];
        const { state } = now;
        show(opener, teaches);
        opener.setAttribute("aria-pressed", String(open));
        show(root, open || state !== "none");
        show(invitation.root, teaches);
        show(asks, teaches && (state === "none" || state === "done"));
        asks.disabled = robot?.state !== "running";
        show(asked, state !== "none");
        show(commands, (teaches || drives) && state !== "none");
        show(kick, drives && state === "open");
        show(end, teaches);
        kick.disabled = robot?.state !== "running" || robot?.name !== now.robot;
        setText(score, classTexts.score(now.score));
        if (state === "none") {
            known = "";
            return;
        }
        setText(question, classTexts.question(now, store.robots.length > 1));
        show(answers, state === "open" && !teaches && !drives);
        const about = JSON.stringify([now.robot, now.kick, state]);
        if (about !== known) answers.choose(now.yours);
        known = about;
        setText(words, saying(now));
        setText(yours, (state !== "open" && classTexts.yours(now.yours, state, now.right)) || "");
        fill(bars, now);
    };
}

function saying({ state, answered, of, outcome }) {
    if (state === "open") return classTexts.waiting({ answered, of });
    if (state === "locked") return classTexts.runs;
    return classTexts.outcome(outcome);
}

/** The answers as bars. Right ones have a mark, too. */
function fill(bars, { counts, answered, right }) {
    show(bars, Boolean(counts));
    const rows = answered ? Object.entries(counts ?? {}) : [];
    const said = JSON.stringify([rows, right]);
    if (bars.dataset.said === said) return;
    bars.dataset.said = said;
    bars.replaceChildren(
        ...rows.map(([guess, count]) => {
            const bar = element("span", { className: "bar" });
            bar.style.inlineSize = `${(100 * count) / answered}%`;
            const label = element("span", {}, classTexts.row(guess, count, answered));
            if (right.includes(guess)) label.append(" ", element("b", {}, classTexts.right));
            return element("li", {}, label, bar);
        }),
    );
    if (counts && !answered) bars.append(element("li", {}, classTexts.nobody));
}

/** The address for watching, large enough for a projector. */
function createInvitation(lab) {
    const image = element("div", { className: "qr", role: "img" });
    image.setAttribute("aria-label", classTexts.qrLabel);
    const url = element("p", { className: "address" });
    const note = element("p", { className: "fine" });
    const shown = element("div", { className: "shown", hidden: true }, image);
    shown.append(element("div", {}, url, note));
    const toggle = button(classTexts.invite, async () => {
        if (shown.hidden) {
            const found = await lab.request({ type: "invite" }).catch((no) => lab.tell(no));
            if (!found) return;
            const { documentElement } = new DOMParser().parseFromString(found.svg, "text/html");
            image.replaceChildren(documentElement.querySelector("svg"));
            setText(url, found.url);
            setText(note, found.local ? classTexts.inviteLocal : classTexts.inviteNote);
        }
        show(shown, shown.hidden);
        toggle.textContent = shown.hidden ? classTexts.invite : classTexts.hide;
    });
    return { root: element("div", { className: "invitation" }, toggle, shown) };
}
