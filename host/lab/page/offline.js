/**
 * Keeps the files of a page without a server, so that it opens without a network, too. In front of
 * this stand CACHE, a name with a hash of all files, and FILES, their names.
 */

/* global CACHE, FILES */

const OURS = "kickctl-";

async function keepAll() {
    const cache = await caches.open(CACHE);
    // Not from the browser's own store, which may hold files of an earlier release.
    await cache.addAll(FILES.map((name) => new Request(name, { cache: "reload" })));
    await self.skipWaiting();
}

async function forgetOthers() {
    const old = (await caches.keys()).filter((name) => name.startsWith(OURS) && name !== CACHE);
    await Promise.all(old.map((name) => caches.delete(name)));
    await self.clients.claim();
}

async function answer(request) {
    const cache = await caches.open(CACHE);
    return (await cache.match(request, { ignoreSearch: true })) ?? fetch(request);
}

self.oninstall = (event) => event.waitUntil(keepAll());
self.onactivate = (event) => event.waitUntil(forgetOthers());
self.onfetch = (event) => {
    if (event.request.method === "GET") event.respondWith(answer(event.request));
};
