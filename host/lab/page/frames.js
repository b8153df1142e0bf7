/** The drawing frames: what is drawn when, and how long it took. */

const BEAT_MS = 200;
const KEPT = 300;

export class Frames {
    #drawings = [];
    #visible = new Set();
    #times = new Float64Array(KEPT);
    #beaten = 0;
    #appeared = false;

    /**
     * @param {() => boolean} update Called in each frame; whether there is something new to draw.
     * @param {() => void} beat Called several times a second as long as frames are drawn.
     */
    constructor(update, beat) {
        this.update = update;
        this.beat = beat;
        /** In how many frames something was drawn. */
        this.count = 0;
        this.#watch = new IntersectionObserver((entries) => {
            for (const { target, isIntersecting } of entries) {
                if (isIntersecting) this.#visible.add(target);
                else this.#visible.delete(target);
            }
            this.#appeared = true;
        });
        this.#next = requestAnimationFrame((now) => this.#frame(now));
    }

    #watch;
    #next;

    /** Draw no more. */
    stop() {
        cancelAnimationFrame(this.#next);
        this.#watch.disconnect();
    }

    /**
     * Draw a canvas in each frame in which there is something new and it can be seen.
     * @param {HTMLCanvasElement} canvas
     * @param {(canvas: HTMLCanvasElement, state: object, theme: object) => void} draw
     * @param {() => [object, object] | null} view What to draw, and its theme; null for nothing.
     */
    add(canvas, draw, view) {
        this.#drawings.push({ canvas, draw, view });
        this.#watch.observe(canvas);
    }

    /** @returns {number} The time that 95 of 100 frames' own drawings stay below, ms. */
    p95() {
        const times = this.#times.slice(0, Math.min(this.count, KEPT)).sort();
        return times.length ? times[Math.floor(0.95 * (times.length - 1))] : 0;
    }

    // The browser calls no frames on a hidden page: nothing is drawn then, and nothing beats.
    #frame(now) {
        this.#next = requestAnimationFrame((next) => this.#frame(next));
        if (now - this.#beaten >= BEAT_MS) {
            this.#beaten = now;
            this.beat();
        }
        const began = performance.now();
        const news = this.update();
        const inView = this.#drawings.filter(({ canvas }) => this.#visible.has(canvas));
        // What has come into view, or has another size, is empty.
        const empty = inView.map(({ canvas }) => fit(canvas)).includes(true) || this.#appeared;
        this.#appeared = false;
        if (!inView.length || !(news || empty)) return;
        for (const { canvas, draw, view } of inView) {
            // One that is being hidden, of which the browser has not told yet, covers nothing.
            if (!(canvas.width && canvas.height)) continue;
            const seen = view();
            if (seen) draw(canvas, ...seen);
        }
        this.#times[this.count % KEPT] = performance.now() - began;
        this.count += 1;
    }
}

/** Give a canvas as many pixels as it covers on the screen. Returns whether these are others. */
function fit(canvas) {
    const width = Math.round(canvas.clientWidth * devicePixelRatio);
    const height = Math.round(canvas.clientHeight * devicePixelRatio);
    if (canvas.width === width && canvas.height === height) return false;
    [canvas.width, canvas.height] = [width, height];
    return true;
}
