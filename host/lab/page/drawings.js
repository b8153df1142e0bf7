/** The drawings of the robot that is shown: which view each canvas of the page has. */

import { byId, element } from "./dom.js";
import { draw as drawFloor } from "./draw/floor.js";
import { draw as drawPlane } from "./draw/plane.js";
import { draw as drawStrips } from "./draw/strips.js";
import { draw as drawWheel } from "./draw/wheel.js";
import { onBasins } from "./ground.js";
import { texts } from "./texts.js";

/**
 * Draw the robot in each frame.
 * @param {import("./frames.js").Frames} frames
 * @param {{themeFor: Function}} screen As in screen.js.
 * @param {() => import("./views.js").Views | null} views Those of now; null for none.
 * @param {(id: string) => ?HTMLElement} find Finds the canvases, not all of which need be there,
 *     and the key.
 */
export function addDrawings(frames, screen, views, find = byId) {
    // Each with the room that its text needs: letters in a line, and lines.
    const drawings = [
        ["left-wheel", drawWheel, ({ wheels }) => wheels.left, 21, 19],
        ["right-wheel", drawWheel, ({ wheels }) => wheels.right, 21, 19],
        ["strips", drawStrips, ({ strips }) => strips, 30, 16],
        ["lag-plane", onBasins(drawPlane), ({ lag }) => lag, 17, 10],
        ["phi-plane", drawPlane, ({ phi }) => phi, 17, 10],
        ["x-plane", drawPlane, ({ x }) => x, 17, 10],
        ["floor", drawFloor, ({ floor }) => floor, 17, 10],
    ];
    for (const [id, draw, view, letters, lines] of drawings) {
        const canvas = find(id);
        if (!canvas) continue;
        frames.add(canvas, draw, () => {
            const now = views();
            return now && [view(now), screen.themeFor(canvas, letters, lines)];
        });
    }
    find("key").append(...markItems());
}

/** The items of a key: what the wheels' colours are. */
export const markItems = () =>
    Object.entries(texts.key).map(([mark, words]) =>
        element("li", { className: `mark-${mark}`, title: texts.keyHints[mark] ?? "" }, words),
    );

/** Say by the labels of the wheels' canvases how they turn. */
export function labelWheels(views, find = byId, ids = ["left-wheel", "right-wheel"]) {
    ["left", "right"].forEach((side, n) => {
        const label = texts.wheelLabel(side, views?.wheels[side]);
        find(ids[n]).setAttribute("aria-label", label);
    });
}
