/** How the page is shown: light or dark, for a desk or for a projector. */

import { byId } from "./dom.js";
import { media, theme } from "./theme.js";

const PROJECTOR = "lab.projector";
// The names of the theme's colours that the key beside the wheels shows.
const MARKS = ["target", "actual", "force", "memory"];
// A drawing has room for a line of this many letters' heights, and for this many lines.
const LETTERS = 19;
const LINES = 6;
const WIDE = matchMedia("(min-width: 1600px)");

export class Screen {
    constructor() {
        this.button = byId("projector");
        this.button.onclick = () => {
            localStorage.setItem(PROJECTOR, String(!this.projector));
            this.#renew();
        };
        addEventListener("resize", () => this.#renew());
        matchMedia("(prefers-color-scheme: dark)").onchange = () => this.#renew();
        this.#renew();
    }

    /** @returns {boolean} Whether the text is as large as a projector needs it. */
    get projector() {
        const chosen = localStorage.getItem(PROJECTOR);
        return chosen === null ? WIDE.matches : chosen === "true";
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
    }

    /**
     * The theme for a drawing; a narrow one has a smaller text.
     * @param {HTMLCanvasElement} canvas
     * @returns {object}
     */
    themeFor(canvas) {
        const room = Math.min(canvas.clientWidth / LETTERS, canvas.clientHeight / LINES);
        const text = Math.min(this.theme.text, room);
        return text < this.theme.text ? { ...this.theme, text } : this.theme;
    }
}
