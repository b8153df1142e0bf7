/**
 * A log to be replayed, as the lab has prepared it. The page itself holds it, or the lab does.
 */

import { readKey } from "./keys.js";

/**
 * Get the tape of this page.
 * @returns {Promise<object>} See `unpackTape`. It fails with an Error in words.
 */
export async function loadTape() {
    const inside = document.getElementById("tape");
    return unpackTape(JSON.parse(inside ? inside.textContent : await fetched()));
}

/**
 * @param {object} packed As MESSAGES.md says.
 * @returns {Promise<{tape: object, records: DataView, twin: ?object}>} What the tape says, its
 *     packed records, and those of the twin with their own derived channels.
 */
export async function unpackTape({ records, twin, ...tape }) {
    return {
        tape: { ...tape, twin: twin && { motor: twin.motor, kicks: twin.kicks } },
        records: await unpacked(records),
        twin: twin && { derived: twin.derived, records: await unpacked(twin.records) },
    };
}

async function fetched() {
    const name = new URLSearchParams(location.search).get("log") ?? "";
    const headers = { Authorization: `Bearer ${readKey()}` };
    const answer = await fetch(`replays/${encodeURIComponent(name)}`, { headers });
    const text = await answer.text();
    if (!answer.ok) throw new Error(text.trim());
    return text;
}

async function unpacked(base64) {
    const text = atob(base64);
    const bytes = new Uint8Array(text.length);
    for (let n = 0; n < bytes.length; n += 1) bytes[n] = text.charCodeAt(n);
    const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new DataView(await new Response(plain).arrayBuffer());
}
