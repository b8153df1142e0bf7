/** The slider with its marks, the buttons beside it, and the keys that move the cursor. */

import { button, choices, element, setText } from "./dom.js";
import { words } from "./replay_texts.js";

// How far an arrow goes with Shift, s.
const LEAP_S = 1;
// A notebook has several, and their choices must not be the same.
let players = 0;

/**
 * @param {(id: string) => HTMLElement} find Finds the slider, `time`, and where the buttons go,
 *     `player`.
 * @param {EventTarget} keys Where keys move the cursor.
 * @param {import("./cursor.js").Cursor} cursor
 * @param {{marks: import("./marks.js").Mark[], ticks: Float64Array, begin_s: number}} log
 * @returns {() => void} Brings the player up to date.
 */
export function createPlayer(find, keys, cursor, { marks, ticks, begin_s }) {
    const { times } = cursor;
    const total_s = times[times.length - 1] - begin_s;
    const slider = find("time");
    slider.max = times.length - 1;
    slider.oninput = () => cursor.go(Number(slider.value));
    const play = button("", () => cursor.toggle(), "record");
    const beside = (step) => () => {
        const places = marks.map(({ place }) => place);
        const found =
            step < 0
                ? places.findLast((place) => place < cursor.place)
                : places.find((place) => place > cursor.place);
        cursor.go(found ?? (step < 0 ? 0 : times.length - 1));
    };
    const byTime = (seconds) => cursor.seek(cursor.time_s + seconds);
    const acts = {
        ArrowLeft: () => cursor.go(cursor.place - 1),
        ArrowRight: () => cursor.go(cursor.place + 1),
        "Shift ArrowLeft": () => byTime(-LEAP_S),
        "Shift ArrowRight": () => byTime(LEAP_S),
        Home: () => cursor.go(0),
        End: () => cursor.go(times.length - 1),
        ",": beside(-1),
        ".": beside(1),
        " ": () => cursor.toggle(),
    };
    const small = (sign, name, key) => {
        const one = button(sign, acts[key], "step");
        one.setAttribute("aria-label", name);
        one.title = name;
        return one;
    };
    const speeds = Object.entries(words.speeds)
        .map(([value, label]) => ({ value: Number(value), label }))
        .sort((one, other) => one.value - other.value);
    players += 1;
    const speed = choices(`speed-${players}`, words.speed, speeds, cursor.speed, (value) => {
        cursor.speed = value;
    });
    speed.classList.add("inline");
    const time = element("output");
    find("player").append(
        small("⇤", words.former, ","),
        small("‹", words.back, "ArrowLeft"),
        play,
        small("›", words.forth, "ArrowRight"),
        small("⇥", words.next, "."),
        time,
        speed,
    );
    keys.addEventListener("keydown", (event) => press(event, acts, slider));

    return () => {
        if (Number(slider.value) !== cursor.place) slider.value = cursor.place;
        const since_s = cursor.time_s - begin_s;
        const said = words.sliderText(ticks[cursor.place], since_s, total_s);
        if (!cursor.playing) slider.setAttribute("aria-valuetext", said);
        setText(play, cursor.playing ? words.pause : words.play);
        setText(time, words.time(since_s, total_s));
    };
}

/** A key moves the cursor, unless it belongs to the control that has the focus. */
function press(event, acts, slider) {
    const { target } = event;
    // Some keyboards need Shift for the dot.
    const shifted = event.shiftKey && `Shift ${event.key}`;
    const key = shifted in acts ? shifted : event.key;
    if (!(key in acts) || event.ctrlKey || event.altKey || event.metaKey) return;
    const own = target !== slider && target.closest?.("input, [tabindex='0']");
    const pressed = key === " " && target.closest?.("button, summary, a");
    if (own || pressed) return;
    event.preventDefault();
    acts[key]();
}
