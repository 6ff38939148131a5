// The spacecraft: start, flight, pause, landing. The gel flies it as any game's controller would.

import { openPage } from "../shared/header.js";
import { element } from "../shared/wire.js";
import { MOUSE, makeGel, makeGestureButtons } from "../gel/pressed_gel.js";
import { Flight, RINGS } from "./flight.js";
import { adviseGesture, playScript, readGamepad, readStream, REST, steer } from "./pilot.js";
import { Scene } from "./scene.js";
import { Sound } from "./sound.js";

const find = (id) => document.getElementById(id);
const scene = new Scene(find("sky"));
const sound = new Sound();
const calm = matchMedia("(prefers-reduced-motion: reduce)");
const IDLE_S = 45; // then the attract mode begins, if nobody has touched anything
const LETTERS_OFF = /^( |Enter|Arrow\w+)$/; // keys that speech input does not produce
const LEAST_TRIALS = 3;

let state = null; // of the stream
let mode = "start"; // start, flying, watching, paused, result
let flight = new Flight({ steady: calm.matches });
let idle = 0;
let touched = false; // a person is here, who may take any time
let flights = 0;
let previous = null; // seconds to aim at a ring, of the flight before
let paused = "flying"; // the mode to go back to
let driver = "running"; // the driver's state in the stream
let byDriver = false; // the flight pauses because the driver does

const page = openPage(60, {
  state(newest) {
    state = newest;
    if (find("gel-panel").hidden === hasGel()) find("gel-panel").hidden = !hasGel();
    followDriver(newest.state);
  },
  driver(runs) { if (!runs) state = null; },
  throughput: showFigures,
}, { gap_ms: 2500 });

// The mouse gel is on this page, beside the flight that it steers.
const gel = makeGel(find("gel"), (command) => page.send(command));
makeGestureButtons(find("gestures"), gel.hand);
const hasGel = () => state !== null && state.slow.source === MOUSE;

const texts = {};
function say(id, text) {
  if (texts[id] !== text) find(id).textContent = texts[id] = text;
}

const options = () => ({ pull: find("pull").checked, pushOnly: find("push-only").checked });

function show(next) {
  mode = next;
  document.body.dataset.mode = next;
  const panels = { start: "start", paused: "pause-panel", result: "result" };
  for (const [name, id] of Object.entries(panels)) find(id).hidden = name !== next;
  find("pause").hidden = !["flying", "watching"].includes(next);
  find("take-over").hidden = next !== "watching";
  const focus = { start: "fly", paused: "go-on", result: "again", watching: "take-over",
    flying: hasGel() ? "gel" : "pause" }[next];
  // The header's button keeps the focus after a person paused there.
  if (document.activeElement.id !== "pause-resume") find(focus).focus({ preventScroll: true });
  byDriver = touched = false;
  idle = 0;
}

function begin(next) {
  flights += 1;
  flight = new Flight({ seed: flights, steady: calm.matches, auto: find("push-only").checked,
    pace: next === "watching" ? 1 : find("pace").value / 100 });
  if (find("sound").checked) sound.start();
  show(next);
}

function land() {
  sound.say("over");
  const rings = `${flight.passed} of ${RINGS} rings in ${Math.round(flight.time)} seconds.`;
  say("result-words", rings);
  find("measured").hidden = true;
  find("simulated").hidden = !(state && state.slow.simulated);
  say("compare", flight.trials.length < LEAST_TRIALS ? "Too few turns to measure." : "Measuring …");
  if (flight.trials.length >= LEAST_TRIALS) page.ask({ do: "throughput", trials: flight.trials });
  page.tell(`Landed. ${rings}`);
  show("result");
}

function showFigures({ throughput_bit_s: bits, movement_s, error_rate, trials }) {
  const figures = {
    "Turns": String(trials),
    "Time to aim": `${movement_s.toFixed(2)} s`,
    "Aims that missed": `${Math.round(100 * error_rate)} %`,
    "Throughput": `${bits.toFixed(2)} bit/s`,
  };
  find("figures").replaceChildren(...Object.entries(figures).flatMap(([name, value]) =>
    [element("dt", { text: name }), element("dd", { text: value })]));
  find("measured").hidden = false;
  const seconds = movement_s.toFixed(1);
  const before = previous ? `, the flight before ${previous}` : "";
  say("compare", `You aimed at a ring in ${seconds} seconds${before}.`);
  previous = seconds;
}

function choosePilot() {
  const pad = readGamepad();
  if (pad) return { pad, words: "the gamepad" };
  if (state) return { pad: readStream(state), words: "the gel, directly" };
  return { pad: null, words: "no pilot yet" };
}

let before = performance.now();
function turn(now) {
  const dt = Math.min((now - before) / 1000, 0.05);
  before = now;
  if (hasGel()) gel.turn(now, state);
  const pilot = choosePilot();
  showPilot(pilot);
  const awaits = mode === "start" || mode === "watching";
  if (awaits && hasGel() && gel.hand.command.down) begin("flying"); // as Fly does
  if (mode === "start") {
    idle += dt;
    if (idle > IDLE_S && !touched && !calm.matches) begin("watching");
    flight.advance({ ...REST, ...steer(playScript(flight).pad) }, 0.35 * dt);
  } else if (mode === "flying" || mode === "watching") {
    const script = mode === "watching" ? playScript(flight) : null;
    fly(script ? script.pad : pilot.pad, script ? script.words : state ? state.say : "", dt);
  }
  if (!document.hidden) scene.draw(flight, { calm: calm.matches });
  requestAnimationFrame(turn);
}

function fly(pad, words, dt) {
  const what = flight.advance(steer(pad, mode === "watching" ? {} : options()), dt);
  if (what) {
    sound.say(what);
    page.tell(what === "passed" ? `Ring ${flight.passed}.` : "Missed, the next one is ahead.");
  }
  const place = flight.find();
  sound.follow(place, flight.pace);
  say("rings", `${flight.passed} of ${RINGS}`);
  say("speed", `${Math.round(100 * flight.pace)} %`);
  say("roll", `${Math.round((flight.roll * 180) / Math.PI)}°`);
  const advice = adviseGesture(place, mode === "flying" && options().pull);
  say("advice", mode === "watching" ? "To fly yourself, press a key or the screen." : advice);
  if (mode === "flying") page.say(advice);
  say("hand", mode === "watching" ? `Scripted hand: ${words}` : words);
  if (flight.isOver) land();
}

function showPilot({ pad, words }) {
  say("pilot", mode === "watching" ? "a script" : words);
  if (mode !== "start") return;
  say("no-gel", hasGel() ? "To begin, press Fly, or press the gel." : pad ? "To begin, press Fly."
    : "No gel is running yet. Start one on the page Start, or watch.");
}

find("fly").addEventListener("click", () => begin("flying"));
find("watch").addEventListener("click", () => begin("watching"));
for (const id of ["again", "take-over"]) find(id).addEventListener("click", () => begin("flying"));
for (const id of ["leave", "end"]) find(id).addEventListener("click", () => show("start"));
find("pause").addEventListener("click", pause);
find("go-on").addEventListener("click", () => {
  if (driver !== "running") page.ask({ do: "resume" });
  show(paused);
});
find("sound").addEventListener("change", ({ target }) =>
  (target.checked ? sound.start() : sound.stop()));
find("pace").addEventListener("input", ({ target }) => {
  say("pace-value", `${target.value} %`);
  target.setAttribute("aria-valuetext", `${target.value} %`);
});

function pause() {
  paused = mode;
  show("paused");
}

// While the driver is paused the ship cannot be steered, so the flight pauses too.
function followDriver(next) {
  if (next === driver) return;
  driver = next;
  const runs = next === "running";
  say("pause-words", runs ? "" : "The gel is paused. Continue resumes it.");
  if (!runs && mode === "flying") {
    pause();
    byDriver = true;
  } else if (runs && byDriver && mode === "paused") {
    show(paused);
  }
}

// In the attract mode every key means: I am here. A control in use keeps its own keys.
function isToFly({ key, target, repeat, defaultPrevented, ctrlKey, altKey, metaKey }) {
  if (repeat || defaultPrevented || ctrlKey || altKey || metaKey) return false;
  const activates = key === "Enter" || key === " ";
  if (mode === "start") return key === "Enter" && target === document.body;
  const isKey = LETTERS_OFF.test(key) || (key.length === 1 && find("pause-key").checked);
  return mode === "watching" && isKey && !target.closest("header")
    && !(activates && target.closest("a, button, summary"));
}

addEventListener("keydown", (event) => {
  if (isToFly(event)) {
    event.preventDefault(); // the button that gets the focus would take it too
    begin("flying");
  }
  if (event.key !== "Escape") return;
  if (mode === "flying" || mode === "watching") pause();
  else if (mode === "paused") show(paused);
});
addEventListener("click", ({ target }) => {
  if (mode === "watching" && !target.closest("header, a, button, .gel-panel")) begin("flying");
});
for (const sign of ["keydown", "pointerdown", "pointermove", "focusin", "wheel"]) {
  addEventListener(sign, () => { touched = true; }, { passive: true });
}
addEventListener("blur", () => { if (mode === "flying" && !readGamepad() && !state) pause(); });
requestAnimationFrame(turn);
