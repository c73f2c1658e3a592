"use strict";

// Before the viewer: what is handed over by other scripts, and nobody to ask.

const handed = new Map();

/** Keep what a script beside this one brings: gzip as base64. */
function handOver(name, packed) { handed.set(name, packed); }

// The viewer would ask for a newer version and send what it counts. The policy forbids both; here
// they get an empty answer, so that they are not tried again.
self.fetch = async () => new Response("{}", { status: 200 });
