/** What the browser remembers for the page. It may be told not to; then the page does without. */

/**
 * @param {"localStorage" | "sessionStorage"} place For this browser, or for this tab.
 * @param {string} key
 * @returns {string | null} What was kept, null if nothing.
 */
export function recall(place, key) {
    try {
        return window[place].getItem(key);
    } catch {
        return null;
    }
}

/**
 * Keep a text.
 * @param {"localStorage" | "sessionStorage"} place For this browser, or for this tab.
 * @param {string} key
 * @param {string} text
 */
export function keep(place, key, text) {
    try {
        window[place].setItem(key, text);
    } catch {
        // then a reload does not know it
    }
}
