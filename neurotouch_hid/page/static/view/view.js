// The live view: shows each state in every part of the page.

import { openPage } from "../shared/header.js";
import { makeUndo } from "../shared/undo.js";
import { element, showOptions } from "../shared/wire.js";
import { makeBars } from "./bars.js";
import { drawDisc } from "../shared/disc.js";
import { makeCurve } from "./curve.js";
import { makePad } from "../shared/pad.js";
import { limit, listMarks, nameMark, showValue } from "./marks.js";

const find = (id) => document.getElementById(id);
const STAGES = {
  rest: "rest detection", tracker: "tracker", gesture: "gesture", profile: "profile and filter",
  device: "to the kernel",
};

const bars = makeBars(find("bars"), save);
const curve = makeCurve({
  canvas: find("curve"), handles: find("curve-handles"), select: find("curve-choice"), save,
  words: (binding, point) => say("curve-words", !binding ? "No output follows a gesture here."
    : `${binding.rest} to ${binding.full} ${binding.unit}` +
      (point ? `; now ${point[0].toFixed(1)} ${binding.unit} gives ${percent(point[1])}` : "")),
});
const showPad = makePad(find("pad"), find("pressed"));

let about = null;
let newest = null;
let shownProfile = null; // whose marks are drawn
let layer = "";
let drawn = false;
let late = false; // the profile has changed while a mark was held
const unanswered = new Map(); // changed values, by the number with which the server answers

const page = openPage(30, {
  state(state) {
    newest = state;
    if (!drawn) {
      drawn = true;
      requestAnimationFrame(draw);
    }
  },
  about(message) {
    about = message;
    showUndo(Boolean(about && about.can_undo));
    keepUnanswered();
    showLayer(true);
  },
  driver(runs) {
    if (runs) return;
    newest = null;
    find("say").textContent = "No driver is running. Start one on the page Start.";
    say("gel-words", "");
    drawDisc(find("disc"), null);
  },
  saved(sentence, { n }) {
    unanswered.delete(n);
    say("saved", sentence);
    page.say(sentence);
    if (late) showLayer(true);
  },
  refused(_, { n }) {
    unanswered.delete(n);
    say("saved", "");
  },
  hello() {
    unanswered.clear(); // a new connection does not answer requests of the old one
  },
});

const isOther = () => (about && about.profile) !== shownProfile;

function save(key, mark, value) {
  if (isOther()) {
    const sentence = "Another profile plays now, so nothing was saved.";
    say("saved", sentence);
    page.tell(sentence);
    showLayer(true);
    return;
  }
  unanswered.set(page.ask({ do: "set", key, mark, value }), { key, mark, value });
  keepUnanswered();
}

// The server's profile is older than changes that it has not answered yet.
function keepUnanswered() {
  const bindings = about && about.layers ? about.layers.flatMap((each) => each.bindings) : [];
  for (const { key, mark, value } of unanswered.values()) {
    for (const binding of bindings.filter((each) => each.key === key)) {
      for (const part of [binding, binding.curve || {}]) if (mark in part) part[mark] = value;
    }
  }
}

function percent(share) {
  return `${Math.round(100 * share)} %`;
}

const texts = {};
function say(id, text) {
  if (texts[id] !== text) find(id).textContent = texts[id] = text;
}

function draw() {
  drawn = false;
  const state = newest;
  if (!state) return;
  const now = performance.now();
  say("say", state.say);
  page.say(state.say);
  if (state.layer !== layer) {
    layer = state.layer;
    showLayer(false);
  }
  bars.show(state.gesture, now);
  drawDisc(find("disc"), state);
  curve.show(state, now);
  showPad(state.pad, state.gesture.kind === "none");
  showTitles(state);
  showActions(state);
  showSlow(state);
}

function showLayer(fresh) {
  const found = about && about.layers && about.layers.find((each) => each.name === layer);
  const edit = Boolean(about && about.edit);
  // A dragged mark stays with the person; the new values appear after it is released.
  late = (fresh || isOther()) && document.querySelector(".mark.held") !== null;
  if (late) return;
  shownProfile = about && about.profile;
  const focused = document.activeElement;
  const { key, mark } = (focused && focused.dataset) || {};
  // One mark may be drawn several times: in the bars of a push's directions and in the curve.
  const listSame = () => [...document.querySelectorAll(
    `.mark[data-key="${CSS.escape(key)}"][data-mark="${mark}"]`)];
  const place = key ? listSame().indexOf(focused) : -1;
  bars.showMarks(found, edit);
  curve.showBindings(found, edit);
  showEditor(found, edit);
  const again = place >= 0 && listSame()[place];
  if (again) again.focus();
}

function showTitles(state) {
  const { slow } = state;
  say("layer", about && about.layers && about.layers.length > 1 ? `Layer: ${state.layer}` : "");
  const atRest = state.gesture.kind === "none";
  const hand = about && about.resting ? "hand resting" : "no hand";
  say("gel-words", describeGel(state.gel));
  const isSeen = state.gel.found && slow.tracked >= state.gel.markers / 4;
  say("rest", !isSeen ? "no gel" : atRest ? `neutral, ${hand}` : state.gesture.phase);
}

function describeGel({ found, text, missing, named, px_per_mm, blur_px }) {
  const words = [`The gel is ${text}.`];
  if (missing.length) {
    const dots = missing.length === 1 ? "1 dot is" : `${missing.length} dots are`;
    words.push(`${dots} not seen (a cross each): ${named}, counted from the top left.`);
  }
  if (found && px_per_mm) words.push(`Scale: ${px_per_mm} px/mm.`);
  if (found && blur_px !== null) words.push(`Blur of a dot: ${blur_px} px.`);
  return words.join(" ");
}

let told = null;
function showActions({ actions }) {
  const key = actions.map((each) => each[0] + each[2]).join();
  if (key === told) return;
  told = key;
  const signs = { pressed: "●", ignored: "✕", missed: "✕", layer: "◆", command: "■", fatigue: "☾" };
  find("actions").replaceChildren(...actions.toReversed().map(([t_us, verdict, what, why]) =>
    element("li", { class: verdict },
      element("span", { class: "sign", "aria-hidden": "true", text: signs[verdict] || "" }),
      element("span", { class: "at", text: `${(t_us / 1e6).toFixed(1)} s` }),
      element("span", { text: `${verdict}: ${what}` }),
      ...(why ? [element("span", { class: "why", text: `because ${why}` })] : []))));
  if (!actions.length) find("actions").append(element("li", { text: "Nothing yet." }));
}

let slowest = "";
function showSlow({ slow, gel }) {
  const key = JSON.stringify(slow);
  if (key === slowest) return;
  slowest = key;
  const rows = [["time slice", slow.window_ms, slow.window_ms]];
  for (const [stage, name] of Object.entries(STAGES)) {
    if (slow.stages && slow.stages[stage]) rows.push([name, ...slow.stages[stage]]);
  }
  if (about && about.filter_ms) rows.push([`tremor filter ${about.filter}`, about.filter_ms,
    about.filter_ms]);
  if (slow.hand_ms) rows.push(["mouse to pad, in total", ...slow.hand_ms]);
  find("stages").replaceChildren(...rows.map(([name, median, most], i) => element("tr", {},
    element("th", { scope: "row" },
      element("span", { class: `swatch swatch-${i % 7}`, "aria-hidden": "true" }), name),
    element("td", { text: `${median.toFixed(2)} ms` }),
    element("td", { text: `${most.toFixed(2)} ms` }))));
  const stacked = rows.filter(([name]) => !name.startsWith("mouse"));
  const all = stacked.reduce((sum, [, median]) => sum + median, 0) || 1;
  find("stack").replaceChildren(...stacked.map(([, median], i) => {
    const part = element("span", { class: `swatch-${i % 7}` });
    part.style.width = `${(100 * median) / all}%`;
    return part;
  }));
  const facts = {
    "events": `${slow.events_hz.toLocaleString("en")} per second`,
    "events lost": slow.lost.toLocaleString("en"),
    "markers tracked": `${slow.tracked} of ${gel.markers}`,
    "since the last rest": slow.rezero_s === null ? "not seen yet" : `${slow.rezero_s} s`,
    "backlog": `${slow.backlog_ms} ms`,
    "frames": `${slow.frames_hz} per second`,
    "slices": `${slow.slices_hz} per second`,
    "source": slow.source,
    "pad": slow.device,
  };
  if (slow.rumble) {
    facts["co-pilot"] = slow.copilot;
    facts["rumble"] = `strong ${slow.rumble.strong}, weak ${slow.rumble.weak}`;
  }
  find("health").replaceChildren(...Object.entries(facts).flatMap(([name, fact]) =>
    [element("dt", { text: name }), element("dd", { text: fact })]));
  find("disc").setAttribute("aria-label",
    `The gel from above: ${slow.tracked} of ${gel.markers} markers tracked`);
}

// The same marks for people who do not drag: a list, minus and plus.
let entries = [];
function showEditor(found, edit) {
  find("editor").hidden = !edit;
  if (!edit) return;
  const select = find("mark-choice");
  const before = entries[Number(select.value)];
  entries = (found ? found.bindings : []).filter((binding) => binding.key !== null)
    .flatMap((binding) => listMarks(binding).map((mark) => ({ binding, mark })));
  showOptions(select, entries.map(({ binding, mark }, i) => [String(i), nameMark(binding, mark)]));
  const again = before ? entries.findIndex(({ binding, mark }) =>
    binding.key === before.binding.key && mark === before.mark) : -1;
  if (entries.length) select.value = String(Math.max(again, 0));
  showEntry();
}

function showEntry(value) {
  const entry = entries[Number(find("mark-choice").value)];
  say("mark-name", entry ? nameMark(entry.binding, entry.mark) : "");
  say("mark-value", entry ? `${value ?? entry.binding[entry.mark]} mm` : "–");
}

// Selects the mark in use also in the list, which has its full name.
function chooseEntry({ key, mark }, value) {
  const found = entries.findIndex((each) => each.binding.key === key && each.mark === mark);
  if (found < 0) return;
  find("mark-choice").value = String(found);
  showEntry(value);
}

function step(by) {
  const entry = entries[Number(find("mark-choice").value)];
  if (!entry) return;
  const { binding, mark } = entry;
  const value = limit(binding, mark, binding[mark] + by);
  showValue(binding.key, mark, value);
  save(binding.key, mark, value);
  showEntry();
}

document.addEventListener("letgo", () => late && showLayer(true));
document.addEventListener("moved", ({ detail }) => chooseEntry(detail, detail.value));
document.addEventListener("focusin", ({ target }) => {
  if (target.matches(".mark")) chooseEntry(target.dataset, target.getAttribute("aria-valuenow"));
});
find("mark-choice").addEventListener("change", () => showEntry());
find("mark-less").addEventListener("click", () => step(-0.1));
find("mark-more").addEventListener("click", () => step(0.1));
const showUndo = makeUndo(find("undo"), "There is no change to undo.",
  () => page.ask({ do: "undo" }), page.tell);
find("editor").addEventListener("submit", (event) => event.preventDefault());
addEventListener("resize", () => newest && draw());
drawDisc(find("disc"), null);
