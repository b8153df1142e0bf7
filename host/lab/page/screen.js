/** How the page is shown: light or dark, for a desk or for a projector. */

import { byId } from "./dom.js";
import { keep, recall } from "./storage.js";
import { fitted, media, theme } from "./theme.js";

const PROJECTOR = "lab.projector";
// The names of the theme's colours that keys beside drawings show.
const MARKS = ["target", "actual", "force", "memory", "forward", "backward", "rest"];
const WIDE = matchMedia("(min-width: 1600px)");
// Where the style sheet lays the parts out below each other, too.
const NARROW = matchMedia("(max-width: 68rem)");

export class Screen {
    /** @param {() => void} changed Called when all is to be drawn anew. */
    constructor(changed = () => {}) {
        this.changed = changed;
        this.chosen = recall("localStorage", PROJECTOR);
        this.button = byId("projector");
        this.button.onclick = () => {
            this.chosen = String(!this.projector);
            keep("localStorage", PROJECTOR, this.chosen);
            this.#renew();
        };
        addEventListener("resize", () => this.#renew());
        matchMedia("(prefers-color-scheme: dark)").onchange = () => this.#renew();
        this.#renew();
    }

    /** @returns {boolean} Whether the text is as large as a projector needs it. */
    get projector() {
        return this.chosen === null ? WIDE.matches : this.chosen === "true";
    }

    #renew() {
        const { projector } = this;
        document.documentElement.classList.toggle("projector", projector);
        this.button.setAttribute("aria-pressed", String(projector));
        this.theme = theme(media(window), projector);
        for (const name of MARKS) {
            const colour = this.theme.colours[name];
            document.documentElement.style.setProperty(`--${name}`, colour);
        }
        this.changed();
    }

    /**
     * The theme for a drawing; a small one has a smaller text, but not on a projector.
     * @param {HTMLCanvasElement} canvas
     * @param {number} letters For how many letters' heights the drawing needs room in a line.
     * @param {number} lines For how many lines it needs room.
     * @returns {object}
     */
    themeFor(canvas, letters, lines) {
        if (this.projector && !NARROW.matches) return this.theme;
        return fitted(this.theme, canvas, letters, lines);
    }
}
