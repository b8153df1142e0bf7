/** A log at a cursor: its drawings and its player, for a page and for a notebook. */

import { Cursor } from "./cursor.js";
import { draw as drawMarks } from "./draw/marks.js";
import { addDrawings, labelWheels } from "./drawings.js";
import { Frames } from "./frames.js";
import { marksOf } from "./marks.js";
import { createPlayer } from "./player.js";
import { RecordedRobot } from "./recorded.js";
import { Views } from "./views.js";

// Half of the width of the slider's thumb, CSS pixels.
const THUMB = 8;

export class Reel {
    #changed = true;
    #drawn = [];
    #labelled = null;

    /**
     * @param {{tape: object, records: DataView}} log As `unpackTape` returns it.
     * @param {{theme: object, themeFor: Function}} screen As in screen.js.
     * @param {(id: string) => ?HTMLElement} find Finds canvases, the key and the player's parts.
     * @param {EventTarget} keys Where keys move the cursor.
     */
    constructor({ tape, records }, screen, find, keys) {
        this.robot = new RecordedRobot(tape, records);
        const { columns } = this.robot.ring;
        this.cursor = this.robot.playout = new Cursor(columns.t_s);
        this.views = new Views(this.robot);
        this.views.linked = true;
        this.marks = marksOf(tape, this.robot.ring);
        /** Called in each frame that is drawn, after the views; with whether wheels got labels. */
        this.onframe = () => {};
        const log = { marks: this.marks, ticks: columns.tick, begin_s: tape.begin_s };
        this.#player = createPlayer(find, keys, this.cursor, log);
        this.#screen = screen;
        this.#find = find;
        this.frames = new Frames(
            () => this.#update(),
            () => {},
        );
        addDrawings(this.frames, screen, () => this.views, find);
        const band = find("marks");
        const state = { marks: this.marks, count: tape.ticks, edge: THUMB };
        this.frames.add(band, drawMarks, () => [state, screen.themeFor(band, 1, 1.5)]);
    }

    #player;
    #screen;
    #find;

    /** Something has changed that is seen. */
    renew() {
        this.#changed = true;
    }

    #update() {
        const { robot, cursor, views } = this;
        cursor.advance(performance.now() / 1000);
        const now = [cursor.time_s, this.#screen.theme];
        if (now.some((one, n) => one !== this.#drawn[n])) this.renew();
        if (!this.#changed) return false;
        [this.#changed, this.#drawn] = [false, now];
        robot.setPlace(cursor.place);
        views.update();
        this.#player();
        const label = !cursor.playing && this.#labelled !== cursor.place;
        if (label) {
            this.#labelled = cursor.place;
            labelWheels(views, this.#find);
        }
        this.onframe(label);
        return true;
    }
}
