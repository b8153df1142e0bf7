/** The key that lets this page into the lab. It stands in the address, behind the `#`. */

import { keep, recall } from "./storage.js";

const KEY = "lab.key";
const PAGE = "lab.page";

/** @returns {string} The key that the address has now, empty if it has none. */
export function keyInAddress() {
    return /^#(?:drive|view)=(.+)$/.exec(location.hash)?.[1] ?? "";
}

/**
 * The key of this page. The address keeps it, so that a reload and a copied address work; the
 * session keeps it, too, in case somebody shortens the address.
 * @returns {string} The key, empty if there is none.
 */
export function readKey() {
    const key = keyInAddress();
    if (!key) return recall("sessionStorage", KEY) ?? "";
    keep("sessionStorage", KEY, key);
    return key;
}

/**
 * The number that the lab gave this page before a reload or a lost connection.
 * @returns {number | null}
 */
export function readPage() {
    const page = recall("sessionStorage", PAGE);
    return page === null ? null : Number(page);
}

/** @param {number} page The number of this page, to come back with. */
export function keepPage(page) {
    keep("sessionStorage", PAGE, String(page));
}
