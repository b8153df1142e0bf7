/** How words and numbers are put together. */

/** @param {number} value @param {number} digits @returns {string} A number with a real minus. */
export function number(value, digits = 2) {
    return Number.isFinite(value) ? value.toFixed(digits).replace("-", "−") : "–";
}

/** @returns {string} A number with the word that fits it. */
export const counted = (count, one, many) => `${count} ${count === 1 ? one : many}`;

/** @returns {string} Words that begin with a capital letter. */
export const capital = (words) => words.charAt(0).toUpperCase() + words.slice(1);

/**
 * What happened, and what to do next, as sentences. Commands stand in quotes in them: back-ticks
 * are for a terminal.
 * @param {...(string | null | undefined)} parts
 * @returns {string}
 */
export function sentences(...parts) {
    return parts
        .filter(Boolean)
        .map((part) => part.replace(/`([^`]*)`/g, "‘$1’"))
        .map((part) => capital(part) + (/[.?!…]$/.test(part) ? "" : "."))
        .join(" ");
}
