/** A log in a notebook: its drawings at a cursor, and a player. */

import { element, setText } from "./dom.js";
import { Board, Onlookers, part } from "./notebook.js";
import { Reel } from "./reel.js";
import { words } from "./replay_texts.js";
import { STATES } from "./robot_view.js";
import { unpackTape } from "./tape.js";

export default () => {
    let onlookers = null;

    return {
        initialize({ model }) {
            onlookers = new Onlookers(model);
        },

        async render({ model, el }) {
            const log = await unpackTape(model.get("tape"));
            const { tape } = log;
            const state = element("b", { className: "state" });
            const name = element("span", {}, [tape.name, tape.part].filter(Boolean).join(", "));
            const marks = part("canvas", "marks", {});
            marks.setAttribute("aria-hidden", "true");
            const slider = part("input", "time", { type: "range", min: 0, value: 0, step: 1 });
            slider.setAttribute("aria-label", words.slider);
            const board = new Board(
                el,
                [element("div", { className: "facts" }, state, name)],
                [element("div", { className: "player" }, marks, slider, part("div", "player"))],
            );
            const reel = new Reel(log, board, board.find, board.root);
            board.keepKeys();
            const { cursor, views, robot } = reel;
            const stateNow = () => STATES[robot.ring.columns.state[cursor.place]];
            reel.onframe = () => {
                state.dataset.state = stateNow();
                setText(state, words.states[stateNow()]);
            };
            // For tests, and for people at the console.
            board.root.kickctl = () => ({
                ticks: tape.ticks,
                place: cursor.place,
                playing: cursor.playing,
                shown_s: views.time,
                state: stateNow(),
                wheels: structuredClone(views.wheels),
            });
            onlookers.come();
            return () => {
                reel.frames.stop();
                onlookers.go();
            };
        },
    };
};
