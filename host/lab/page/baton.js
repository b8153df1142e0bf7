/** Who drives: ask for the baton, take it, hand it on. */

import { button, element, setText, show } from "./dom.js";
import { texts } from "./texts.js";
import { sentences } from "./words.js";

/**
 * @param {HTMLElement} root
 * @param {import("./lab.js").Lab} lab
 * @returns {() => void} Brings the panel up to date.
 */
export function createBaton(root, lab) {
    const who = element("p");
    const asking = element("p", { role: "status" });
    const gives = element("div", { className: "buttons" });
    const leave = button(texts.leave, () => send({ type: "leave" }));
    const count = element("p", { className: "fine" });
    root.append(who, asking, gives, leave, count);
    let offered = "";

    const send = (message) => lab.request(message).catch((no) => lab.tell(no));

    return () => {
        const { baton, role, page, pages, canDrive, link } = lab.store;
        const mine = baton.you ? texts.youDrive : canDrive ? texts.youMay : "";
        const other = baton.driver === null ? texts.nobodyDrives : texts.pageDrives(baton.driver);
        const known = sentences(mine || other, baton.you ? "" : baton.why);
        setText(who, link.up ? known : texts.driverUnknown);
        // Who may take the baton may hand it on, too, also where nobody drives.
        const others = link.up && (baton.you || role === "drive") ? baton.asking : [];
        setText(asking, others.length ? texts.asks(others) : "");
        if (offered !== others.join()) {
            offered = others.join();
            gives.replaceChildren(
                ...others.map((page) =>
                    button(texts.give(page), () => send({ type: "give", page })),
                ),
            );
        }
        show(leave, link.up && baton.you);
        setText(count, link.up ? texts.pages(page, pages) : "");
    };
}
