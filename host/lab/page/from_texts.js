/** Loads modules from their texts, where no server has them. This is the only one that may. */

const loaded = (globalThis.kickctlModules ??= new Map());

/**
 * @param {Object<string, string>} texts By path, each behind those that it imports, by lab/PATH.
 * @param {string} first The path of the one that is wanted.
 * @param {string} digest Of all texts: what is loaded once serves each widget of the window.
 * @returns {Promise<object>} What that one exports.
 */
export function load(texts, first, digest) {
    if (!loaded.has(digest)) loaded.set(digest, begin(texts, first));
    return loaded.get(digest);
}

async function begin(texts, first) {
    const urls = new Map();
    for (const [path, text] of Object.entries(texts)) {
        const own = text.replace(/"lab\/([\w./]+)"/g, (_, needed) => `"${urls.get(needed)}"`);
        urls.set(path, URL.createObjectURL(new Blob([own], { type: "text/javascript" })));
    }
    const module = await import(urls.get(first));
    for (const url of urls.values()) URL.revokeObjectURL(url);
    return module;
}
