/** The list of what happened in a log; a click goes there. */

import { button, element } from "./dom.js";
import { words } from "./replay_texts.js";

/**
 * @param {HTMLElement} root
 * @param {import("./marks.js").Mark[]} marks
 * @param {import("./cursor.js").Cursor} cursor
 * @param {number} begin_s When the log begins, s.
 * @returns {() => void} Brings the list up to date.
 */
export function createHappened(root, marks, cursor, begin_s) {
    const items = marks.map(({ place, kind, words: said }) => {
        const text = words.happenedAt(cursor.times[place] - begin_s, said);
        const item = button(text, () => cursor.go(place), "link");
        item.dataset.kind = kind;
        return item;
    });
    const list = element("ol", {}, ...items.map((item) => element("li", {}, item)));
    root.append(items.length ? list : element("p", { className: "fine" }, words.nothingHappened));
    let shown = null;

    return () => {
        const latest = marks.findLastIndex(({ place }) => place <= cursor.place);
        if (latest === shown) return;
        items[shown]?.removeAttribute("aria-current");
        items[latest]?.setAttribute("aria-current", "true");
        shown = latest;
    };
}
