// The mouse's gel: wishes for the simulated hand out, what the real line makes of them in.

import { colour, connect, element, makeAnnouncer } from "./wire.js";
import { drawDisc, findScale } from "./disc.js";
import { Hand } from "./hand.js";
import { makePad } from "./pad.js";

const GESTURES = {
  push_left: "← Push left", push_right: "→ Push right", push_up: "↑ Push up",
  push_down: "↓ Push down", pinch: "Pinch (−)", zoom: "Zoom (+)",
  twist_ccw: "↺ Twist (Q)", twist_cw: "↻ Twist (E)",
};
const AGAIN_MS = 100; // a held wish is repeated, so that the simulator knows a person is there
const LEAST_MS = 6; // mice may report a thousand times a second; the gel has 250 moments

const find = (id) => document.getElementById(id);
const canvas = find("gel");
const announce = makeAnnouncer(find("live"));
const showPad = makePad(find("pad"), find("pressed"));
const hand = new Hand(canvas, (event) => {
  const { left, top, width, height } = canvas.getBoundingClientRect();
  const scale = findScale(width, height);
  return [(event.clientX - left - width / 2) / scale, (event.clientY - top - height / 2) / scale];
});

let newest = null;
let drawn = null; // each state once: the browser needs its time for the mouse
const wire = connect(30, {
  state(state) { newest = state; },
  driver: (runs) => notice(runs ? "" : "No driver is running. Start it: neurotouch demo --mouse"),
  lost: notice,
  refused: notice,
  hello: () => notice(""),
});

function notice(sentence) {
  find("notice").textContent = sentence;
  find("notice").hidden = !sentence;
}

const settings = { tremor_mm: 0, weak_zoom: 0, resting: false };
let sent = "";
let sentAt = 0;
function send(at_ms) {
  const wish = { ...hand.wish, ...settings };
  const key = JSON.stringify(wish);
  const now = performance.now();
  const due = key !== sent ? now - sentAt >= LEAST_MS
    : (wish.down || wish.resting) && now - sentAt >= AGAIN_MS;
  if (!due) return;
  sent = key;
  sentAt = now;
  wire.send({ do: "hand", at_ms, ...wish });
}
hand.changed = send;

for (const [gesture, name] of Object.entries(GESTURES)) {
  const button = element("button", { type: "button", text: name, "data-gesture": gesture });
  button.addEventListener("pointerdown", (event) => {
    event.preventDefault();
    button.focus();
    button.setPointerCapture(event.pointerId);
    hand.press(gesture);
  });
  for (const end of ["pointerup", "pointercancel", "blur"]) {
    button.addEventListener(end, () => hand.release(gesture));
  }
  button.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" && event.key !== " ") return;
    event.preventDefault();
    hand.press(gesture);
  });
  button.addEventListener("keyup", () => hand.release(gesture));
  // A click that nothing held down, as screen readers and switches give it: a short press.
  button.addEventListener("click", (event) => {
    if (event.detail) return;
    hand.press(gesture);
    setTimeout(() => hand.release(gesture), 600);
  });
  find("gestures").append(button);
}

find("hold").addEventListener("click", () => {
  hand.held = !hand.held;
  find("hold").setAttribute("aria-pressed", String(hand.held));
});

function listenTo(id, read) {
  const input = find(id);
  const change = () => {
    const words = read(input);
    if (words !== undefined) find(`${id}-value`).textContent = words;
  };
  input.addEventListener("input", change);
  change();
}
listenTo("size", ({ value }) => { hand.size_mm = Number(value); return `${value} mm`; });
listenTo("tremor", ({ value }) => { settings.tremor_mm = Number(value); return `${value} mm`; });
listenTo("weak", ({ value }) => { settings.weak_zoom = value / 100; return `${value} %`; });
listenTo("resting", ({ checked }) => { settings.resting = checked; });

let before = performance.now();
function turn(now) {
  hand.advance(Math.min((now - before) / 1000, 0.1), now);
  before = now;
  send(performance.timeOrigin + performance.now());
  if (newest && newest !== drawn) {
    drawn = newest;
    drawDisc(canvas, newest);
    show(newest);
  }
  requestAnimationFrame(turn);
}

const texts = {};
function say(id, text) {
  if (texts[id] !== text) find(id).textContent = texts[id] = text;
}

function show(state) {
  say("say", state.say);
  announce(state.say);
  showPad(state.pad, state.gesture.kind === "none");
  const { slow } = state;
  say("badges", `· profile ${state.profile}`);
  say("lag", slow.hand_ms
    ? `mouse to pad ${slow.hand_ms[0].toFixed(0)} ms, 95 % within ${slow.hand_ms[1].toFixed(0)} ms`
    : "");
  if (slow.source && slow.source !== "sim:mouse") {
    notice(`The driver plays ${slow.source}. For a gel to press: neurotouch demo --mouse`);
  }
  const wish = hand.wish;
  if (!wish.down) return;
  const context = canvas.getContext("2d");
  context.strokeStyle = colour("warm");
  context.lineWidth = 0.5;
  context.beginPath();
  context.arc(wish.x_mm + wish.push_x_mm, wish.y_mm + wish.push_y_mm, 6.5, 0, 2 * Math.PI);
  context.stroke();
}

drawDisc(canvas, null);
addEventListener("resize", () => { drawn = null; });
requestAnimationFrame(turn);
