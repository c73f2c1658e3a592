"use strict";

// The document's address names the recording's script: player.html#<row>/<file>.js.

const NAME = /^[a-z0-9][a-z0-9._-]*\/[a-z0-9][a-z0-9._-]*\.js$/i;

/** The bytes that a script provided. */
async function unpacked(name) {
  const packed = Uint8Array.from(atob(provided.get(name)), (letter) => letter.charCodeAt(0));
  provided.delete(name);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Run the script in the row's folder that provides its recording. */
function load(name) {
  return new Promise((done, failed) => {
    const script = document.createElement("script");
    script.src = `../rows/${name}`;
    script.onload = done;
    script.onerror = () => failed(new Error(`no recording ${name}`));
    document.head.append(script);
  });
}

function say(text) { document.getElementById("said").textContent = text; }

async function play() {
  const name = decodeURIComponent(location.hash.slice(1));
  if (!NAME.test(name) || name.includes("..")) { throw new Error("no recording is named"); }
  await load(name);
  await wasm_bindgen({ module_or_path: await unpacked("program") });
  const viewer = new wasm_bindgen.WebHandle({
    url: [],
    hide_welcome_screen: true,
    persist: false,
    enable_history: false,
    render_backend: "webgl",
    theme: matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light",
  });
  const canvas = document.getElementById("viewer");
  await viewer.start(canvas);
  // The top panel is about the viewer, not about the recording.
  viewer.override_panel_state("top", "hidden");
  viewer.open_channel("recording", name);
  viewer.send_rrd_to_channel("recording", await unpacked("recording"));
  say("");
  canvas.focus();
  parent.postMessage("playing", "*");
  watch(viewer);
  // Another player may be opened at once: this one releases its graphics context.
  addEventListener("pagehide", () => viewer.destroy());
}

/** Report a crash of the viewer. */
function watch(viewer) {
  if (viewer.has_panicked()) {
    fail(new Error(viewer.panic_message()));
  } else {
    setTimeout(watch, 1000, viewer);
  }
}

function fail(error) {
  say(`The recording can't be played here: ${error.message}. Use lcrl-bench view instead: the command is in its row.`);
  parent.postMessage("failed", "*");
}

play().catch(fail);
