/**
 * Keeps the files of a page without a server, so that it opens without a network, too. In front of
 * this stand CACHE, a hash of all files, and FILES, their names.
 */

/* global CACHE, FILES */

// Other folders of the same site may have a page like this one, and all share one list of caches.
const OURS = `kickctl ${self.registration.scope} `;
const OWN = OURS + CACHE;

async function keepAll() {
    const cache = await caches.open(OWN);
    // Not from the browser's own store, which may hold files of an earlier release.
    await cache.addAll(FILES.map((name) => new Request(name, { cache: "reload" })));
    await self.skipWaiting();
}

async function forgetOthers() {
    const old = (await caches.keys()).filter((name) => name.startsWith(OURS) && name !== OWN);
    await Promise.all(old.map((name) => caches.delete(name)));
    await self.clients.claim();
}

async function answer(request) {
    const cache = await caches.open(OWN);
    return (await cache.match(request, { ignoreSearch: true })) ?? fetch(request);
}

self.oninstall = (event) => event.waitUntil(keepAll());
self.onactivate = (event) => event.waitUntil(forgetOthers());
self.onfetch = (event) => {
    if (event.request.method === "GET") event.respondWith(answer(event.request));
};
