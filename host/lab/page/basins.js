/** Where starts lead, under the lag plane: its switch, its key, and what slice it is. */

import { byId, element, setText, show } from "./dom.js";
import { keep, recall } from "./storage.js";
import { texts } from "./texts.js";
import { sentences } from "./words.js";

const KEPT = "lab.basins";
const OFF = "off";

/** An item of a key: where starts lead that are drawn so. */
export const endItem = (end, ...words) => element("li", { className: `end ${end}` }, ...words);

/**
 * @param {HTMLElement} root
 * @param {HTMLCanvasElement} canvas The plane, which gets a description.
 * @param {import("./lab.js").Lab} lab
 * @returns {() => void} Brings the panel up to date.
 */
export function createBasins(root, canvas, lab) {
    // The lab computes them once for all pages, and a page draws them once for each change.
    let on = recall("localStorage", KEPT) !== OFF;
    let following = null;
    const toggle = byId("basins-switch");
    toggle.onclick = () => {
        on = !on;
        keep("localStorage", KEPT, on ? "on" : OFF);
        lab.changed = true;
    };
    const parts = Object.entries(texts.ends).map(([end, name]) => {
        const share = element("span");
        return { end, name, share, item: endItem(end, name, share) };
    });
    const key = element("ul", { className: "key" }, ...parts.map(({ item }) => item));
    const words = element("p", { className: "fine" });
    root.append(key, words);

    return () => {
        const { robot } = lab.store;
        lab.store.basins = on;
        // After a lost link, and once it is found, a robot is another object.
        const wanted = on && robot ? robot : null;
        if (wanted !== following) {
            following = wanted;
            if (robot) robot.picture = null;
            lab.send({ type: "basins", robot: wanted && wanted.name });
        }
        toggle.setAttribute("aria-pressed", String(on));
        const { basins, picture, status } = robot ?? {};
        show(key, Boolean(basins));
        const found = parts.filter(({ end }) => basins?.counts[end]);
        for (const part of parts) {
            show(part.item, found.includes(part));
            if (!basins) continue;
            setText(part.share, texts.share(basins.counts[part.end] / basins.ends.length));
        }
        const described = basins && texts.basinsOf(found.map(({ item }) => item.textContent));
        canvas.setAttribute("aria-label", sentences(texts.lagPlane, described));
        show(words, on && Boolean(robot));
        if (basins) setText(words, texts.basinsSlice(basins));
        else if (picture?.why) setText(words, texts.noBasins(picture.why));
        else if (robot) setText(words, texts.computing({ ...status.params }));
    };
}
