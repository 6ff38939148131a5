// The spacecraft: start, flight, pause, landing. The gel flies it as any game's controller would.

import { connect, element, makeAnnouncer } from "./wire.js";
import { Flight, RINGS } from "./flight.js";
import { adviseGesture, playScript, readGamepad, readStream, REST, steer } from "./pilot.js";
import { Scene } from "./scene.js";
import { Sound } from "./sound.js";

const find = (id) => document.getElementById(id);
const announce = makeAnnouncer(find("live"), 2500);
const scene = new Scene(find("sky"));
const sound = new Sound();
const calm = matchMedia("(prefers-reduced-motion: reduce)");
const IDLE_S = 45; // then the attract mode begins by itself
const LEAST_TRIALS = 3;

let state = null; // of the stream
let mode = "start"; // start, flying, watching, paused, result
let flight = new Flight({ steady: calm.matches });
let idle = 0;
let flights = 0;
let previous = null; // throughput of the flight before

const wire = connect(60, {
  state(newest) { state = newest; },
  driver(runs) { if (!runs) state = null; },
  throughput: showFigures,
  refused: (sentence) => say("compare", sentence),
});

const texts = {};
function say(id, text) {
  if (texts[id] !== text) find(id).textContent = texts[id] = text;
}

const options = () => ({ pull: find("pull").checked, pushOnly: find("push-only").checked });

function show(next) {
  mode = next;
  const panels = { start: "start", paused: "pause-panel", result: "result" };
  for (const [name, id] of Object.entries(panels)) find(id).hidden = name !== next;
  find("pause").hidden = !["flying", "watching"].includes(next);
  const focus = { start: "fly", paused: "go-on", result: "again", flying: "pause",
    watching: "pause" }[next];
  find(focus).focus({ preventScroll: true });
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
  find("figures").replaceChildren();
  say("compare", flight.trials.length < LEAST_TRIALS ? "Too few turns to measure." : "Measuring …");
  if (flight.trials.length >= LEAST_TRIALS) wire.send({ do: "throughput", trials: flight.trials });
  announce(`Landed. ${rings}`);
  show("result");
}

function showFigures({ throughput_bit_s: bits, movement_s, error_rate, trials }) {
  const figures = {
    "Throughput (ISO 9241-411)": `${bits.toFixed(2)} bit/s`,
    "Time to aim at a ring": `${movement_s.toFixed(2)} s`,
    "Aims that missed": `${Math.round(100 * error_rate)} %`,
    "Turns measured": String(trials),
  };
  find("figures").replaceChildren(...Object.entries(figures).flatMap(([name, value]) =>
    [element("dt", { text: name }), element("dd", { text: value })]));
  const change = previous ? ` The flight before: ${previous.toFixed(2)} bit/s.` : "";
  say("compare", `Each ring is a target, your course the pointer.${change}`);
  previous = bits;
}

function choosePilot() {
  const pad = readGamepad();
  if (pad) return { pad, words: "Flown by the gamepad" };
  if (state) return { pad: readStream(state), words: "Flown by the stream" };
  return { pad: null, words: "" };
}

let before = performance.now();
function turn(now) {
  const dt = Math.min((now - before) / 1000, 0.05);
  before = now;
  const pilot = choosePilot();
  showPilot(pilot);
  if (mode === "start") {
    idle += dt;
    if (idle > IDLE_S && !calm.matches) begin("watching");
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
    announce(what === "passed" ? `Ring ${flight.passed}.` : "Missed, the next one is ahead.");
  }
  const place = flight.find();
  sound.follow(place, flight.pace);
  say("rings", `${flight.passed} of ${RINGS}`);
  say("speed", `${Math.round(100 * flight.pace)} %`);
  say("roll", `${Math.round((flight.roll * 180) / Math.PI)}°`);
  const advice = adviseGesture(place, mode === "flying" && options().pull);
  say("advice", mode === "watching" ? "" : advice);
  if (mode === "flying") announce(advice);
  say("hand", mode === "watching" ? `Scripted hand: ${words}` : words);
  if (flight.isOver) land();
}

function showPilot({ pad, words }) {
  const simulated = state && String(state.slow.source || "").startsWith("sim:");
  const who = mode === "watching" ? "Flown by a script" : words;
  say("badges", [simulated ? "SIMULATED" : "", who].filter(Boolean).join(" · "));
  if (mode !== "start") return;
  say("notice", pad ? "" : "No gel is here yet. Start one: neurotouch demo --mouse. Or watch.");
}

find("fly").addEventListener("click", () => begin("flying"));
find("watch").addEventListener("click", () => begin("watching"));
find("again").addEventListener("click", () => begin("flying"));
for (const id of ["leave", "end"]) find(id).addEventListener("click", () => show("start"));
find("pause").addEventListener("click", pause);
find("go-on").addEventListener("click", () => show(paused));
find("sound").addEventListener("change", ({ target }) =>
  (target.checked ? sound.start() : sound.stop()));
find("pace").addEventListener("input", ({ target }) => say("pace-value", `${target.value} %`));

let paused = "flying";
function pause() {
  paused = mode;
  show("paused");
}
addEventListener("keydown", (event) => {
  if (event.key !== "Escape" && event.key !== "p") return;
  if (mode === "flying" || mode === "watching") pause();
  else if (mode === "paused") show(paused);
});
addEventListener("blur", () => { if (mode === "flying" && !readGamepad() && !state) pause(); });
requestAnimationFrame(turn);
