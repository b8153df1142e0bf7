/** Runs the lab and its robot in Pyodide, and passes messages on. */

import { loadPyodide } from "./pyodide/pyodide.js";

const EVERY_MS = 15;
const FOLDER = "/lab";
const now = () => performance.now() / 1000;

/** The seed that the page gives as this worker's name, or one by chance. */
function seed() {
    return self.name ? Number(self.name) : crypto.getRandomValues(new Uint32Array(1))[0];
}

/** Send the page a message of Python: text, or bytes. */
function say(message) {
    if (typeof message === "string") postMessage(message);
    else {
        const { buffer } = message.toJs();
        postMessage(buffer, [buffer]);
    }
}

const fail = (error) => postMessage(JSON.stringify({ type: "failed", why: String(error) }));

try {
    const python = await loadPyodide();
    const answer = await fetch("python.zip");
    if (!answer.ok) throw new Error(`python.zip: ${answer.status}`);
    python.unpackArchive(await answer.arrayBuffer(), "zip", { extractDir: FOLDER });
    python.runPython(`import sys; sys.path.insert(0, "${FOLDER}")`);
    python.pyimport("host.util.own_name").choose("this page");
    const { BrowserLab } = python.pyimport("host.lab.browser_lab");
    const lab = BrowserLab(seed(), now(), say);
    const attempt = (work) => {
        try {
            work();
        } catch (error) {
            clearInterval(clock);
            fail(error);
        }
    };
    const clock = setInterval(() => attempt(() => lab.step(now())), EVERY_MS);
    onmessage = ({ data }) => attempt(() => lab.receive(data, now()));
} catch (error) {
    fail(error);
}
