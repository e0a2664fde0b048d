// Shows the screen of the program (worker.js), and sends it keys, clicks, files and links.
'use strict';

const screen = document.getElementById('screen');
const message = document.getElementById('message');
const worker = new Worker('worker.js');
// Files of this folder stay in the browser; the others are downloaded.
const KEPT = '/stickslip/';
// The screens need at least 80 columns.
const COLUMNS = 80;
const WIDEST_FONT = 16;

let size = { columns: 0, rows: 0 };
// For scripts that drive the page.
const state = { pending: 0, busy: true, memory: 0, loaded: null, trace: null, drawn: null, failed: null, send };
window.stickslip = state;

function send(request) {
  state.pending += 1;
  worker.postMessage(request);
}

worker.onmessage = ({ data: update }) => {
  if (update.failed) {
    state.failed = update.failed;
    message.textContent = `The program failed: ${update.failed} Reload the page to start again.`;
    return;
  }
  for (const [at, html] of update.rows) {
    if (screen.children[at]) screen.children[at].innerHTML = html;
  }
  for (const [path, content] of update.files) store(path, content);
  if (update.copy !== undefined) navigator.clipboard?.writeText(update.copy);
  if (update.trace !== undefined) state.trace = update.trace;
  if (update.pictures !== undefined) showPictures(update.pictures);
  state.memory = update.memory;
  state.loaded ??= performance.now();
  state.pending -= update.answers;
  state.busy = update.busy;
};

// Keeps a written file in the browser, or downloads it.
function store(path, content) {
  if (path.startsWith(KEPT)) {
    if (content === null) localStorage.removeItem(path);
    else keep(path, content);
  } else if (content !== null) {
    const bytes = typeof content === 'string' ? content : new Uint8Array(content);
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([bytes]));
    link.download = path.split('/').pop();
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60000);
  }
}

// If the browser's storage is full, the oldest journals are removed: their names end with the date.
function keep(path, content) {
  const date = (name) => name.match(/\d{8}-\d{6}/)?.[0] ?? '';
  for (;;) {
    try {
      localStorage.setItem(path, JSON.stringify({ modified: Date.now(), content }));
      return;
    } catch (error) {
      const journals = Object.keys(localStorage).filter((key) => key.startsWith(`${KEPT}journals/`) && key !== path);
      if (journals.length === 0) {
        message.textContent = `The browser cannot store ${path}: ${error.message}`;
        return;
      }
      journals.sort((a, b) => date(a).localeCompare(date(b)));
      localStorage.removeItem(journals[0]);
    }
  }
}

function resize() {
  const box = screen.parentElement;
  const font = Math.min(WIDEST_FONT, box.clientWidth / COLUMNS / 0.602);
  screen.style.fontSize = `${font}px`;
  const probe = document.createElement('canvas').getContext('2d');
  probe.font = `100px ${getComputedStyle(screen).fontFamily}`;
  const cell = probe.measureText('M').width / 100 * font;
  const line = Math.floor(font * 1.17);
  screen.style.setProperty('--cell', `${cell}px`);
  screen.style.lineHeight = `${line}px`;
  const columns = Math.max(COLUMNS, Math.floor(box.clientWidth / cell));
  const rows = Math.max(24, Math.floor(box.clientHeight / line));
  if (columns === size.columns && rows === size.rows) return;
  size = { columns, rows };
  screen.replaceChildren(...Array.from({ length: rows }, () => document.createElement('div')));
  send({ resize: size });
}

const NAMES = {
  ' ': 'Space', ArrowUp: 'Up', ArrowDown: 'Down', ArrowLeft: 'Left', ArrowRight: 'Right', Escape: 'Esc',
};
const PLAIN = ['Enter', 'Tab', 'Home', 'End', 'PageUp', 'PageDown', 'Backspace', 'Delete'];

// The name of a key in the key table; null for keys that the browser keeps.
function keyName(event) {
  if (event.metaKey || event.altKey) return null;
  const key = NAMES[event.key] ?? event.key;
  if (key.length === 1 && event.ctrlKey) {
    return window.getSelection().isCollapsed || key !== 'c' ? `Ctrl-${key.toLowerCase()}` : null;
  }
  if (key === 'Tab' && event.shiftKey) return 'Shift-Tab';
  if (/^F\d+$/.test(key)) return event.shiftKey ? `Shift-${key}` : key;
  const isNamed = PLAIN.includes(key) || Object.values(NAMES).includes(key);
  return [...key].length === 1 || isNamed ? key : null;
}

document.addEventListener('keydown', (event) => {
  if (event.target.closest('input, select')) return;
  const name = keyName(event);
  // Reload, developer tools, new tabs and windows, and paste stay with the browser.
  if (name === null || ['Ctrl-v', 'Ctrl-t', 'Ctrl-n', 'F5', 'F12'].includes(name)) return;
  event.preventDefault();
  send({ key: name });
});

document.addEventListener('paste', (event) => {
  const text = event.clipboardData.getData('text');
  if (text) send({ paste: text });
});

function cellOf(event) {
  const box = screen.getBoundingClientRect();
  const column = Math.floor((event.clientX - box.left) / (box.width / size.columns));
  const row = Math.floor((event.clientY - box.top) / (box.height / size.rows));
  return { column: Math.max(0, column), row: Math.max(0, row) };
}

screen.addEventListener('click', (event) => {
  if (window.getSelection().isCollapsed) send({ mouse: { kind: 'click', ...cellOf(event) } });
});
screen.addEventListener('wheel', (event) => {
  send({ mouse: { kind: event.deltaY < 0 ? 'up' : 'down', ...cellOf(event) } });
  event.preventDefault();
}, { passive: false });

for (const button of document.querySelectorAll('#keys button')) {
  button.addEventListener('click', () => {
    send({ key: button.dataset.key ?? button.textContent });
    button.blur();
  });
}

// Where there is no keyboard: a line such as `:set friction.angle 20`, or the answer to a question.
document.getElementById('line').addEventListener('submit', (event) => {
  event.preventDefault();
  const [text] = event.target.elements;
  for (const letter of text.value) send({ key: NAMES[letter] ?? letter });
  send({ key: 'Enter' });
  text.value = '';
});

const pictures = document.getElementById('pictures');
const [angle, part, increment] = pictures.querySelectorAll('input');
const problem = document.getElementById('problem');
// The scene of the pictures with its own increment; one request is under way at a time.
let base = null;
let isDrawing = false;
let isStale = false;

function draw() {
  isStale = isDrawing;
  if (isDrawing || pictures.hidden) return;
  isDrawing = true;
  const settings = base === null ? []
    : [['friction.angle', angle.value], ['history.increment', String(base.increment * 2 ** increment.value)]];
  state.asked = performance.now();
  send({ pictures: { settings, part: Number(part.value) } });
}

function showPictures({ Ok: found, Err: why }) {
  isDrawing = false;
  problem.textContent = why ?? '';
  if (found !== undefined) {
    if (base === null) {
      base = { scene: found.scene, increment: found.increment };
      angle.value = found.angle ?? 0;
      increment.value = 0;
    } else if (base.scene !== found.scene) {
      // Another scene was opened meanwhile, and got the settings of the old one.
      base = null;
      isStale = true;
    }
    const values = [`${angle.value}°`, found.load.toPrecision(4), found.increment.toPrecision(3)];
    pictures.querySelectorAll('output').forEach((output, at) => { output.textContent = values[at]; });
    pictures.querySelectorAll('.picture').forEach((box, at) => {
      const { Ok: svg, Err: missing } = found.drawn[at];
      if (svg === undefined) box.textContent = missing;
      else box.innerHTML = svg;
    });
    state.drawn = performance.now() - state.asked;
  }
  if (isStale) draw();
}

for (const slider of [angle, part, increment]) slider.addEventListener('input', draw);
document.getElementById('show').addEventListener('change', (event) => {
  pictures.hidden = !event.target.checked;
  base = null;
  resize();
  draw();
});

// A dropped file is stored under its name; the last one is opened.
async function take(files) {
  for (const file of files) {
    const bytes = new Uint8Array(await file.arrayBuffer());
    let content;
    try {
      content = new TextDecoder('utf-8', { fatal: true, ignoreBOM: true }).decode(bytes);
    } catch {
      content = Array.from(bytes);
    }
    send({ file: { path: file.name, content, modified: file.lastModified } });
  }
  if (files.length > 0) send({ open: [['journal', files[files.length - 1].name]] });
}

document.addEventListener('dragover', (event) => event.preventDefault());
document.addEventListener('drop', (event) => {
  event.preventDefault();
  take([...event.dataTransfer.files]);
});
document.getElementById('file').addEventListener('change', (event) => {
  take([...event.target.files]);
  event.target.value = '';
});

// A link such as #lesson=oscillation or #scene=osc-two6&friction.angle=20.
function follow() {
  const settings = [...new URLSearchParams(location.hash.slice(1))];
  if (settings.length > 0) send({ open: settings });
}

for (const [path, text] of Object.entries(localStorage)) {
  if (!path.startsWith(KEPT)) continue;
  // Earlier pages stored the content alone.
  const kept = JSON.parse(text);
  send({ file: { path, content: kept.content ?? kept, modified: kept.modified ?? 0 } });
}
const light = window.matchMedia('(prefers-color-scheme: light)');
send({ background: { light: light.matches } });
light.addEventListener('change', () => send({ background: { light: light.matches } }));
resize();
window.addEventListener('resize', resize);
window.addEventListener('hashchange', follow);
follow();
