/** What the widgets of a notebook share: their parts, their colours, and whether anybody looks. */

import { element } from "./dom.js";
import { texts } from "./texts.js";
import { fitted, media, theme } from "./theme.js";

// A cell that is moved has no view for a moment, ms.
const AWAY_MS = 2000;
const LABELS = { "lag-plane": texts.lagPlane, strips: texts.strips };

/** Counts the views of a widget, and lets the kernel forget it when there are none any more. */
export class Onlookers {
    #count = 0;

    /** @param {{send: (message: object) => void}} model The widget's. */
    constructor(model) {
        this.model = model;
    }

    come() {
        this.#count += 1;
    }

    go() {
        this.#count -= 1;
        setTimeout(() => this.#count || this.model.send({ type: "leave" }), AWAY_MS);
    }
}

/** A widget's place in a cell, with its drawings; a screen in the sense of screen.js. */
export class Board {
    #media = "";
    #theme = null;

    /**
     * @param {HTMLElement} el The notebook's.
     * @param {HTMLElement[]} above What stands above the drawings.
     * @param {HTMLElement[]} below What stands below them.
     */
    constructor(el, above, below) {
        const canvas = (id) => {
            const one = part("canvas", id, { role: "img" });
            if (LABELS[id]) one.setAttribute("aria-label", LABELS[id]);
            return one;
        };
        this.root = element(
            "div",
            { className: "kickctl" },
            ...above,
            element(
                "div",
                { className: "drawings" },
                element("div", { className: "pair" }, canvas("left-wheel"), canvas("right-wheel")),
                canvas("lag-plane"),
                canvas("strips"),
            ),
            part("ul", "key", { className: "key" }),
            ...below,
        );
        el.append(this.root);
        /** Finds one of its parts by name. */
        this.find = (id) => this.root.querySelector(`[data-part="${id}"]`);
    }

    /** Keep JupyterLab from taking keys that are pressed on the controls for its own commands. */
    keepKeys() {
        for (const control of this.root.querySelectorAll("button, input")) {
            control.dataset.lmSuppressShortcuts = "true";
        }
    }

    /** @returns {object} The theme of the notebook, which may be dark on a light system. */
    get theme() {
        const { jpThemeLight, vscodeThemeKind } = document.body.dataset;
        const light = jpThemeLight ? jpThemeLight === "true" : vscodeThemeKind?.endsWith("light");
        const now = media(window, light === undefined ? null : light ? "light" : "dark");
        const key = `${now.dark} ${now.scale}`;
        if (key !== this.#media) {
            this.#media = key;
            this.#theme = theme(now);
            for (const [name, colour] of Object.entries(this.#theme.colours)) {
                this.root.style.setProperty(`--${name}`, colour);
            }
        }
        return this.#theme;
    }

    /** The theme for a drawing, as in screen.js. */
    themeFor(canvas, letters, lines) {
        return fitted(this.theme, canvas, letters, lines);
    }
}

/** An element that `Board.find` finds. */
export function part(tag, id, properties = {}, ...children) {
    const made = element(tag, properties, ...children);
    made.dataset.part = id;
    return made;
}
