/** The basins as a sheet that the lag plane lies on, drawn only when something of it changes. */

import { draw as drawBasins } from "./draw/basins.js";
import { layout } from "./draw/plane.js";

/**
 * @param {(canvas: HTMLCanvasElement, state: object, theme: object) => void} drawPlane
 * @returns {typeof drawPlane} The same on the basins of the state, if it has any.
 */
export function onBasins(drawPlane) {
    const sheet = document.createElement("canvas");
    let drawn = [];

    return (canvas, state, theme) => {
        const { basins, stale, y } = state;
        state.ground = null;
        if (basins) {
            const { scale, text, colours } = theme;
            const box = layout(state, theme, canvas.width / scale, canvas.height / scale);
            const part = (2 * basins.fastest) / (y.maximum - y.minimum);
            const size = [box.width * scale, box.height * part * scale].map(Math.round);
            const now = [basins, stale, text, colours, ...size];
            if (Math.min(...size) > 0) {
                if (now.some((one, place) => one !== drawn[place])) {
                    [sheet.width, sheet.height] = size;
                    drawBasins(sheet, { ...basins, stale }, theme);
                    drawn = now;
                }
                state.ground = { sheet, high: basins.fastest };
            }
        }
        drawPlane(canvas, state, theme);
    };
}
