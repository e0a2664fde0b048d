// Runs the program apart from the page, so that the page always responds.
'use strict';

let program = null;
const waiting = [];
const encoder = new TextEncoder();
const decoder = new TextDecoder();

const imports = { env: { now: () => performance.timeOrigin + performance.now() } };

function output(length) {
  const { memory, output } = program.exports;
  return decoder.decode(new Uint8Array(memory.buffer, output(), length));
}

// Handles a request; `answers` is 1 for one of the page.
function handle(request, answers) {
  const { memory, input, handle, output_length } = program.exports;
  const bytes = encoder.encode(JSON.stringify(request));
  const address = input(bytes.length);
  new Uint8Array(memory.buffer, address, bytes.length).set(bytes);
  try {
    const update = JSON.parse(output(handle()));
    update.memory = memory.buffer.byteLength;
    update.answers = answers;
    postMessage(update);
    return update.busy;
  } catch (error) {
    postMessage({ failed: output(output_length()) || String(error) });
    program = null;
    return false;
  }
}

// Messages of the page are handled between two slices of the solver.
const slices = new MessageChannel();
let isScheduled = false;
slices.port1.onmessage = () => {
  isScheduled = false;
  schedule(program !== null && handle('advance', 0));
};

function schedule(isBusy) {
  if (isBusy && !isScheduled) {
    isScheduled = true;
    slices.port2.postMessage(null);
  }
}

onmessage = ({ data }) => {
  if (program === null) {
    waiting.push(data);
    return;
  }
  schedule(handle(data, 1));
};

fetch('stickslip.wasm')
  .then((response) => response.arrayBuffer())
  .then((bytes) => WebAssembly.instantiate(bytes, imports))
  .then(({ instance }) => {
    program = instance;
    for (const request of waiting.splice(0)) schedule(handle(request, 1));
  })
  .catch((error) => postMessage({ failed: String(error) }));
