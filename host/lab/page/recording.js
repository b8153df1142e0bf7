/** Recording on and off, and the logs of this lab to download. */

import { button, element, setText } from "./dom.js";
import { readKey } from "./keys.js";
import { texts } from "./texts.js";

/**
 * @param {HTMLElement} root
 * @param {import("./lab.js").Lab} lab
 * @returns {() => void} Brings the panel up to date.
 */
export function createRecording(root, lab) {
    const record = button("", () => lab.try("record", { on: !recordingOf(lab) }), "record");
    const now = element("p", { role: "status" });
    const list = element("ul", { className: "logs" });
    const none = element("p", { className: "fine" }, texts.noLogs);
    root.append(record, now, element("h3", {}, texts.logs), list, none);
    let known = null;

    const renew = async () => {
        try {
            const { logs } = await lab.request({ type: "logs" });
            const items = logs.map((log) => element("li", {}, link(log, lab), opened(log)));
            list.replaceChildren(...items);
            none.hidden = items.length > 0;
        } catch {
            known = null; // asked again when the link is back
        }
    };

    return () => {
        const { robot, mayDrive, link } = lab.store;
        const name = recordingOf(lab);
        record.disabled = !mayDrive || !robot;
        record.setAttribute("aria-pressed", String(Boolean(name)));
        setText(record, name ? texts.recordOff : texts.recordOn);
        setText(now, name ? texts.recordingNow(name) : "");
        const state = `${robot?.name} ${name}`;
        if (link.up && robot && known !== state) {
            known = state;
            renew();
        }
    };
}

const recordingOf = (lab) => lab.store.robot?.status.recording ?? null;

function link({ name, whole, failed }, lab) {
    return button(texts.download(name, whole, failed), () => download(name, lab), "link");
}

/** A link that opens a log as a replay; a growing one as far as it is written. */
function opened({ name }) {
    const href = `replay.html?log=${encodeURIComponent(name)}#view=${readKey()}`;
    const link = element("a", { href, target: "_blank", textContent: texts.replay });
    link.setAttribute("aria-label", texts.replayLabel(name));
    return link;
}

/** Fetch a log with the page's key, which an ordinary link could not show. */
async function download(name, lab) {
    try {
        const headers = { Authorization: `Bearer ${readKey()}` };
        const answer = await fetch(`logs/${encodeURIComponent(name)}`, { headers });
        if (!answer.ok) throw new Error(await answer.text());
        const url = URL.createObjectURL(await answer.blob());
        element("a", { href: url, download: name }).click();
        setTimeout(() => URL.revokeObjectURL(url), 60000);
    } catch (error) {
        lab.tell(texts.downloadFailed(error.message));
    }
}
