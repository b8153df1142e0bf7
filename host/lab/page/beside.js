/** All robots and their twins at once, beside each other, in place of one that is shown large. */

import { endItem } from "./basins.js";
import { besideTexts } from "./beside_texts.js";
import { Card } from "./card.js";
import { button, byId, element, setText, show } from "./dom.js";
import { markItems } from "./drawings.js";
import { keep, recall } from "./storage.js";
import { texts } from "./texts.js";

const KEPT = "lab.beside";
const OFF = "off";
// What is cut off below the cards by less than this is their lowest edge.
const LEAST_PX = 8;
// The panels that are about one robot, by the ids of their titles.
const PANELS = ["kicks", "moves", "recording", "parameters", "k-trace", "floor", "state"];

export class Beside {
    #on = recall("localStorage", KEPT) !== OFF;
    #pool = [];
    #cards = [];
    #known = null;
    #whose;
    #below;
    #ends = Object.entries(texts.ends).map(([end, name]) => ({ end, item: endItem(end, name) }));
    #key = element("ul", { className: "key" }, ...markItems());

    /**
     * @param {HTMLElement} root
     * @param {HTMLButtonElement} toggle Shows one robot large instead, and all again.
     * @param {object} page Its `lab`, `stop`, `frames` and `screen`.
     */
    constructor(root, toggle, page) {
        Object.assign(this, { root, toggle, page, lab: page.lab });
        root.setAttribute("aria-label", besideTexts.title);
        setText(toggle, besideTexts.toggle);
        toggle.setAttribute("aria-label", besideTexts.toggleLabel);
        toggle.onclick = () => {
            this.#on = !this.#on;
            keep("localStorage", KEPT, this.#on ? "on" : OFF);
            this.lab.changed = true;
        };
        // Where a system hides its scroll bars, a card that is cut off could seem to be all.
        const down = () => root.scrollBy({ top: 0.7 * root.clientHeight });
        this.#below = button(besideTexts.below, down, "below quiet");
        this.#key.append(...this.#ends.map(({ item }) => item));
        root.after(this.#below, this.#key);
        root.onscroll = () => (this.lab.changed = true);
        this.#whose = PANELS.map((name) => {
            const whose = element("span", { className: "whose" });
            byId(`${name}-title`).append(whose);
            return { name, whose };
        });
    }

    /** @returns {boolean} Whether several are shown. */
    get shown() {
        return this.#on && this.#several;
    }

    get #several() {
        const { robots, twins } = this.lab.store;
        return robots.length + twins.length > 1;
    }

    /**
     * Move all drawings to what is on the screen now.
     * @param {number} now_s The page's clock, s.
     * @returns {boolean} Whether time has passed on one of them.
     */
    move(now_s) {
        if (!this.shown || this.#known !== this.lab.store.robots) return false;
        return this.#cards.map((card) => card.move(now_s)).includes(true);
    }

    /** Say what is known. */
    update() {
        const { store } = this.lab;
        const { robots, robot, targets } = store;
        show(this.toggle, this.#several);
        this.toggle.setAttribute("aria-pressed", String(this.#on));
        show(this.root, this.shown);
        document.documentElement.classList.toggle("side-by-side", this.shown);
        for (const { name, whose } of this.#whose) {
            const all = name === "kicks" && targets.length > 1;
            const words = all ? besideTexts.all : robot?.name;
            setText(whose, robots.length > 1 ? besideTexts.whose(words) : "");
        }
        show(this.#below, this.shown && this.#goesOn);
        show(this.#key, this.shown);
        if (!this.shown) return;
        if (this.#known !== robots) this.#fill(robots);
        for (const card of this.#cards) card.update();
        for (const { end, item } of this.#ends) show(item, Boolean(robot?.basins?.counts[end]));
    }

    /** Whether a card ends below what is seen of the cards. */
    get #goesOn() {
        const { root } = this;
        return root.scrollHeight - root.clientHeight - root.scrollTop > LEAST_PX;
    }

    /** Give each robot and each twin a card. */
    #fill(robots) {
        this.#known = robots;
        const { store } = this.lab;
        const shown = robots.flatMap((robot) => [robot, store.twinOf(robot.name)]).filter(Boolean);
        while (this.#pool.length < shown.length) {
            const card = new Card(this.page, (robot) => {
                store.selected = store.robots.indexOf(robot);
                this.lab.changed = true;
            });
            this.#pool.push(card);
            this.root.append(card.root);
        }
        // Another lab at the same address may have fewer robots.
        this.#cards = this.#pool.slice(0, shown.length);
        for (const card of this.#pool) show(card.root, this.#cards.includes(card));
        this.root.dataset.count = shown.length;
        shown.forEach((robot, n) => this.#cards[n].take(robot));
    }

    /** @returns {object} What is shown, for tests. */
    state() {
        const { shown } = this;
        return { shown, cards: shown ? this.#cards.map((card) => card.state()) : [] };
    }
}
