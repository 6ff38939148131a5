// The connection to the server: the token, reconnecting, and states as plain objects.

const KEY = "neurotouch-token";
const AGAIN_MS = 1000;
const MOST_MARKERS = 400;
const OPEN_AGAIN = "Open NeuroTouch again, or the whole link that the terminal shows.";
const NOT_SENT = "Not connected, so nothing was changed. Try again once the connection is back.";
const NO_ANSWER = "The connection was lost before the answer. Look whether it was done.";
const SETTINGS = ["about", "own"]; // what a person changes on the pages
const decoder = new TextDecoder();

// The token arrives in the fragment, which browsers send to no server and in no referrer. It moves
// to the storage of this tab, so that the address can be shown, shared and bookmarked; it is deleted
// with the tab.
function takeToken() {
  const given = /^#k=([\w-]+)(?:&(.*))?$/.exec(location.hash);
  if (given) {
    sessionStorage.setItem(KEY, given[1]);
    history.replaceState(null, "", location.pathname + (given[2] ? `#${given[2]}` : ""));
  }
  return sessionStorage.getItem(KEY) || "";
}

// Returns a state with its markers, in 0.01 mm; null if the driver is of another version.
function readState(buffer) {
  const view = new DataView(buffer);
  const [length, n] = [view.getUint32(0, true), view.getUint32(4, true)];
  const begin = 8 + length;
  if (n < 1 || n > MOST_MARKERS || buffer.byteLength !== begin + 9 * n) return null;
  const state = JSON.parse(decoder.decode(new Uint8Array(buffer, 8, length)));
  state.places = new Int16Array(buffer.slice(begin, begin + 4 * n));
  state.moved = new Int16Array(buffer.slice(begin + 4 * n, begin + 8 * n));
  state.valid = new Uint8Array(buffer, begin + 8 * n, n);
  return state;
}

// Calls `name` of each listener for each message: `hello`, `state`, `about`, `driver`, `saved`,
// `refused`, `throughput`, and `lost` with a sentence while there is no connection. The whole
// message comes second; what answers a request has the number `n` that `ask` gave it.
export function connect(hz, listeners) {
  const token = takeToken();
  let socket = null;
  let ended = false;
  let asked = 0;
  const kept = new Map(); // the newest settings, as they came
  const unanswered = new Set(); // numbers of requests

  function call(name, ...values) {
    for (const listener of listeners) if (listener[name]) listener[name](...values);
  }

  function open() {
    socket = new WebSocket(`ws://${location.host}/stream`);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => socket.send(JSON.stringify({ token, hz }));
    socket.onmessage = ({ data }) => {
      if (typeof data !== "string") {
        const state = readState(data);
        if (state) return call("state", state);
        return call("lost", "The driver is of another version than this page: start it again.");
      }
      const message = JSON.parse(data);
      unanswered.delete(message.n);
      for (const name of SETTINGS) if (name in message) kept.set(name, data);
      for (const [name, value] of Object.entries(message)) call(name, value, message);
    };
    socket.onclose = ({ code, reason }) => {
      if (code === 1008) {
        ended = true;
        call("lost", `The server refuses this page: ${reason || "its link is wrong"}. ${OPEN_AGAIN}`);
      } else if (code === 1013) {
        call("lost", "Too many viewers (4). Close one.");
      } else {
        call("lost", "The connection is lost. If it stays so, open NeuroTouch again.");
      }
      for (const n of unanswered) call("refused", NO_ANSWER, { n });
      unanswered.clear();
      if (!ended) setTimeout(open, AGAIN_MS);
    };
  }

  if (token) {
    open();
  } else {
    // Once the page is ready to hear it.
    queueMicrotask(() => call("lost", `A part of this page's link is missing. ${OPEN_AGAIN}`));
  }
  keepToken(token);
  takeLongPresses();
  function send(message) {
    const isOpen = socket !== null && socket.readyState === WebSocket.OPEN;
    if (isOpen) socket.send(JSON.stringify(message));
    return isOpen;
  }
  // What the server does with a refused request: says so, and what is changed on the page goes back.
  function refuse(n) {
    call("refused", NOT_SENT, { n });
    for (const [name, data] of kept) call(name, JSON.parse(data)[name], { [name]: true });
  }
  return {
    send,
    ask(message) {
      const n = ++asked;
      if (send({ ...message, n })) unanswered.add(n);
      else queueMicrotask(() => refuse(n));
      return n;
    },
    end() { // what the server showed last stays; it is not looked for again
      ended = true;
    },
  };
}

// A long press is one press: else Enter would press again and again, and the next button too.
function takeLongPresses() {
  addEventListener("keydown", (event) => {
    if (!event.repeat || event.key !== "Enter") return;
    event.preventDefault();
    event.stopPropagation();
  }, { capture: true });
}

// Links to the other pages carry the token, so that each can be opened in a tab of its own.
function keepToken(token) {
  for (const link of document.querySelectorAll("a[data-page]")) {
    link.href = `${link.dataset.page}#k=${token}`;
  }
}

export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key === "text") made.textContent = value;
    else made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

// Gives a list these options, [value, text] each. An option that is there stays: a screen reader
// takes a new one for the person's choice, and leaves the place where it reads.
export function showOptions(select, options) {
  const before = new Map([...select.options].map((option) => [option.value, option]));
  const wanted = options.map(([value, text]) => {
    const option = before.get(value) || element("option", { value });
    if (option.textContent !== text) option.textContent = text;
    return option;
  });
  for (const option of before.values()) if (!wanted.includes(option)) option.remove();
  wanted.forEach((option, i) => {
    if (select.options[i] !== option) select.insertBefore(option, select.options[i] || null);
  });
}

// A canvas in the screen's own pixels; colours come from the style sheet.
export function prepareCanvas(canvas) {
  const ratio = Math.min(devicePixelRatio || 1, 2);
  const { width, height } = canvas.getBoundingClientRect();
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) {
    canvas.width = w;
    canvas.height = h;
  }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}

/* A colour of the style sheet as a canvas takes it: a canvas knows no forced colours, and would
   draw white dots on white where the person's "CanvasText" and its own "Canvas" are both white. */
let colours = null;
export function colour(name) {
  if (!colours) {
    colours = {};
    const forget = () => { colours = null; };
    for (const query of ["(prefers-color-scheme: dark)", "(prefers-contrast: more)",
      "(forced-colors: active)"]) {
      matchMedia(query).addEventListener("change", forget, { once: true });
    }
  }
  colours[name] ??= resolve(`var(--${name})`);
  return colours[name];
}

function resolve(value) {
  const probe = document.body.appendChild(document.createElement("i"));
  probe.style.cssText = `color: ${value}; forced-color-adjust: none`;
  const { color } = getComputedStyle(probe);
  probe.remove();
  return color;
}
