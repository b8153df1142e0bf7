/** The key that lets this page into the lab. It stands in the address, behind the `#`. */

import { keep, recall } from "./storage.js";

const KEY = "lab.key";
const PAGE = "lab.page";

/**
 * The key of this page. The address keeps it, so that a reload and a copied address work; the
 * session keeps it, too, in case somebody shortens the address.
 * @returns {string} The key, empty if there is none.
 */
export function readKey() {
    const match = /^#(?:drive|view)=(.+)$/.exec(location.hash);
    if (!match) return recall("sessionStorage", KEY) ?? "";
    keep("sessionStorage", KEY, match[1]);
    return match[1];
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
