/** What has to be said across the page: no link, not let in, who drives, and what went wrong. */

import { button, element, setText, show } from "./dom.js";
import { texts } from "./texts.js";
import { sentences } from "./words.js";

/**
 * @param {HTMLElement} root
 * @param {HTMLElement} above Where a dead link is said: in view at every place of the page.
 * @param {import("./lab.js").Lab} lab
 * @returns {() => void} Brings the notices up to date.
 */
export function createNotices(root, above, lab) {
    const link = notice("alarm");
    const again = button(texts.again, () => lab.source.open());
    const role = notice("calm");
    role.words.id = "who-drives";
    const ask = button(texts.ask, () => lab.request({ type: "ask" }).catch((no) => lab.tell(no)));
    const take = button(texts.take, () =>
        lab.request({ type: "take" }).catch((no) => lab.tell(no)),
    );
    const note = notice("note");
    const close = button(texts.close, () => lab.tell(null), "quiet");
    link.root.append(again);
    role.root.append(ask, take);
    note.root.append(close);
    note.root.setAttribute("role", "alert");
    above.append(link.root);
    root.append(role.root, note.root);

    return () => {
        const { store } = lab;
        const off = !store.link.up;
        show(link.root, off);
        show(again, Boolean(store.refused));
        if (off) setText(link.words, linkWords(store, lab.source));
        const { driver, you, asking } = store.baton;
        const watching = store.link.up && !store.canDrive;
        show(role.root, watching);
        const waits = asking.includes(store.page);
        const who = driver === null ? texts.nobodyDrives : texts.pageDrives(driver);
        if (watching) setText(role.words, waits ? `${who} ${texts.asked(store.page)}` : who);
        show(ask, !you && !waits);
        show(take, store.role === "drive" && driver !== null);
        show(note.root, Boolean(store.note));
        if (store.note) setText(note.words, noteWords(store.note));
    };
}

// A robot's name stays as it is, though it begins a sentence.
function noteWords({ message, hint, robots }) {
    return robots ? message : sentences(message, hint);
}

function notice(className) {
    const words = element("p");
    const root = element("div", { className: `notice ${className}`, hidden: true }, words);
    return { root, words };
}

function linkWords({ refused, link }, source) {
    if (refused) return sentences(refused.title ?? texts.refused, refused.message, refused.hint);
    if (!link.ever) return source.waiting ?? texts.connecting;
    return texts.noLab((performance.now() - link.since) / 1000);
}
