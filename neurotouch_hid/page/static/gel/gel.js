// The page of the mouse gel: gestures, settings of the hand, and the resulting pad.

import { openPage } from "../shared/header.js";
import { makePad } from "../shared/pad.js";
import { MOUSE, makeGel, makeGestureButtons } from "./pressed_gel.js";

const find = (id) => document.getElementById(id);
const showPad = makePad(find("pad"), find("pressed"));

let newest = null;
let shown = null;
const page = openPage(30, {
  state(state) { newest = state; },
  hello: (_, { edit }) => { find("cure").disabled = !edit; },
  saved: (sentence) => { find("cured").textContent = sentence; },
  driver(runs) {
    page.notice("driver", runs ? "" : "To press a gel: on the page Start, 'Try it without a camera'.");
  },
});

const { hand, settings, turn } = makeGel(find("gel"), (command) => page.send(command));

makeGestureButtons(find("gestures"), hand);

find("hold").addEventListener("click", () => {
  hand.held = !hand.held;
  find("hold").setAttribute("aria-pressed", String(hand.held));
});

function listenTo(id, read) {
  const input = find(id);
  const change = () => {
    const words = read(input);
    if (words === undefined) return;
    find(`${id}-value`).textContent = words;
    input.setAttribute("aria-valuetext", words); // the slider says it, so its output need not
  };
  input.addEventListener("input", change);
  change();
}
listenTo("size", ({ value }) => { hand.size_mm = Number(value); return `${value} mm`; });
listenTo("tremor", ({ value }) => { settings.tremor_mm = Number(value); return `${value} mm`; });
listenTo("weak", ({ value }) => { settings.weak_zoom = value / 100; return `${value} %`; });
listenTo("resting", ({ checked }) => { settings.resting = checked; });
find("cure").addEventListener("click", () =>
  page.ask({ do: "own value", name: "neutral", value: "resting" }));

function draw(now) {
  turn(now, newest);
  if (newest && newest !== shown) {
    shown = newest;
    show(newest);
  }
  requestAnimationFrame(draw);
}

const texts = {};
function say(id, text) {
  if (texts[id] !== text) find(id).textContent = texts[id] = text;
}

function show(state) {
  say("say", state.say);
  page.say(state.say);
  showPad(state.pad, state.gesture.kind === "none");
  const { slow } = state;
  say("lag", slow.hand_ms
    ? `mouse to pad ${slow.hand_ms[0].toFixed(0)} ms, 95 % within ${slow.hand_ms[1].toFixed(0)} ms`
    : "");
  page.notice("driver", !slow.source || slow.source === MOUSE ? ""
    : `The driver uses ${slow.source}. To press a gel, end it on the page Start, then 'Try it without a camera'.`);
}

requestAnimationFrame(draw);
