// The first page: leads from any state to playing, without a terminal.

import { MOUSE, makeGel, makeGestureButtons } from "../gel/pressed_gel.js";
import { openPage } from "../shared/header.js";
import { makeUndo } from "../shared/undo.js";
import { showOptions } from "../shared/wire.js";
import { makeCalibration } from "./calibration.js";
import { makeCheck } from "./check.js";
import { makeChooser } from "./chooser.js";
import { makeCards, makeListener } from "./movements.js";
import { makeOwnValues } from "./own_values.js";
import { makeProfiles } from "./profiles.js";
import { makeRemote } from "./remote.js";
import { makeStart } from "./start.js";
import { makeTrial } from "./trial.js";

const HZ = 30;
const EDITS = ["check", "remote", "undo", "profile-use", "profile-copy", "range-undo", "own-undo"];
// What is said here is announced once, by the header. As live regions of their own, a screen reader
// would read all of them again whenever a dialog closes.
const ANNOUNCED = ["saved", "trial", "range-said", "own-said", "check-state", "remote-state"];
const PAUSE = { do: "pause", for: "movement" }; // which ends with this page

const find = (id) => document.getElementById(id);
let mayEdit = false;
const places = new Map(); // where the answer to a request is said
let refusal = ""; // the place of the last one
let about = null;
let kept = {}; // how far an unfinished measurement is, of a hand and of a simulated one
let newest = null;
let isKnown = false; // the outputs have come
let layer = "";
let doing = false; // a movement is waited for, or its output is chosen
let pausing = false; // the driver is paused for it

const page = openPage(HZ, {
  places,
  hello(_, { edit, far }) {
    start.setLost(false);
    page.send({ do: "profiles" });
    page.send({ do: "outputs" });
    for (const id of EDITS) find(id).disabled = !edit;
    find("far").hidden = !far;
    mayEdit = edit;
    calibration.reset();
    if (pausing) page.send(PAUSE); // the connection was lost, and the driver has gone on
  },
  state(state) {
    if (!start.meet()) return;
    const first = newest === null;
    newest = state;
    profiles.setPlayed(state.profile);
    cards.mark(state.gesture.movement);
    // A movement before the driver has paused still moves the gamepad, and chooses nothing.
    if (state.state !== "running") listener.hear(state.gesture);
    trial.hear(state, performance.now());
    if (first || state.slow !== shownSlow) showAll();
    if (!layer && state.layer) showLayer();
  },
  driver(is) {
    start.setRuns(is);
    if (!is) lose();
    showAll();
  },
  situation(found) { // told while nothing comes
    start.setSituation(found);
    lose();
    showAll();
  },
  plugged(found) {
    start.setPlugged(found);
    showAll();
  },
  about(message) {
    const isFirst = about === null;
    const isOther = about && message && about.profile !== message.profile;
    about = message;
    if (chooser.isOpen && (isOther || !chooser.refresh(findLayer()))) giveUp();
    showUndo(Boolean(about && about.can_undo));
    showLayer();
    if (!isFirst) page.send({ do: "profiles" });
  },
  outputs(groups) {
    chooser.setOutputs(groups);
    isKnown = true; // no button moves away from under the mouse
    showLayer();
  },
  profiles: (found) => profiles.show(found),
  shown: (found, { name }) => profiles.shown(found, name),
  own(found) {
    const { fault, values, unfinished = {}, can_undo: can = {} } = found;
    kept = unfinished;
    showOwnUndo(Boolean(can.values));
    showRangeUndo(Boolean(can.ranges));
    showRange();
    showOwn(values, mayEdit);
    page.notice("own", fault ? `${fault} Below, 'Mend my values' brings back what could be read.` : "");
    find("own-mend").hidden = !(fault && mayEdit);
  },
  lost: () => {
    start.setLost(true);
    calibration.lose();
    showAll();
  },
  saved(sentence, { n }) {
    if (n === copies) profiles.forget();
    if (sentence) say(places.get(n) || "saved", sentence);
    trial.saved(n);
  },
  refused(sentence, { n }) {
    if (!places.has(n)) return;
    refusal = places.get(n);
    find(refusal).classList.add("refused");
    if (refusal === "range-said" && !start.isLost) calibration.reset();
    if (refusal === "start-lines") start.refuse(sentence);
    else say(refusal, sentence);
    showAll();
  },
  picture: (address) => { find("picture").src = address; find("picture").hidden = false; },
  program(news) {
    if (news.name === "check") check.hear(news);
    else if (news.name === "calibrate") {
      calibration.hear(news);
      showAll();
    } else start.hear(news);
  },
  remote: (found) => showRemote(found),
});

// Asks for something; `place` says what becomes of it. The last refusal is over then.
function ask(request, place) {
  page.notice("request", "");
  if (refusal) {
    say(refusal, "");
    find(refusal).classList.remove("refused");
  }
  refusal = "";
  say(place, "");
  const n = page.ask(request);
  places.set(n, place);
  return n;
}

function lose() {
  newest = null;
  profiles.setPlayed("");
  if (!listener.waits) return;
  pausing = false; // there is no driver to resume
  stopListening();
}

// 1 Start

const gel = makeGel(find("gel"), (command) => page.send(command));
makeGestureButtons(find("gestures"), gel.hand);
const hasGel = () => newest !== null && newest.slow.source === MOUSE;
function turn(now) {
  if (hasGel()) gel.turn(now, newest);
  requestAnimationFrame(turn);
}

const start = makeStart(find, { page, ask, say, lose, changed: showAll });

let shownSlow = null;
function showAll() {
  shownSlow = newest ? newest.slow : null;
  for (const id of ["gel", "gesture-buttons"]) find(id).hidden = !hasGel();
  start.show(newest, hasGel());
  find("by-doing").hidden = !(newest && about && about.edit && !profiles.view);
  find("by-doing").disabled = calibration.runs; // both listen to the same movements
  placeGel();
  find("measure").disabled = !newest || !mayEdit || listener.waits;
  showRange();
}

// Beside the question that it answers: nobody scrolls between the two.
function placeGel() {
  const place = find(calibration.runs ? "measuring" : doing ? "doing" : "start-gel");
  const box = find("gel-box");
  if (box.parentElement !== place) place.append(box);
}

function showRange() {
  const known = about && about.ranges ? Object.keys(about.ranges).length : 0;
  const words = known ? [`Your own range is known for ${known} of 8 movements.`] : [];
  const unfinished = kept[newest && newest.slow.simulated ? "simulated" : "hand"] || "";
  calibration.setUnfinished(unfinished);
  if (unfinished && !calibration.runs) {
    words.push(`A measurement is not finished: ${unfinished} are done and kept.`);
  }
  if (!newest) words.push("Start first: then the gamepad can learn your range.");
  else if (!words.length) words.push("Small movements are enough: the gamepad can learn your range.");
  say("range-words", [...words, "There is no time limit."].join(" "));
}

function say(id, text) {
  if (find(id).textContent === text) return;
  find(id).textContent = text;
  if (ANNOUNCED.includes(id)) page.tell(text);
}

// 2 What each movement does

const cards = makeCards(find("cards"), {
  choose: (movement, instead) => chooser.open(movement, findLayer(), instead),
  remove: (binding) => ask({ do: "unbind", key: binding.key }, "saved"),
  name: (output) => chooser.name(output),
});
const chooser = makeChooser(find("chooser"), {
  bind(wish) {
    const n = ask({ do: "bind", layer, ...wish }, "saved");
    const plays = newest !== null && newest.layer === layer;
    if (plays) trial.ask(n, wish.movement, wish.do_this);
    else trial.clear();
  },
  closed: endListening,
  isQuiet: () => newest === null || newest.state !== "running",
});

const trial = makeTrial(find, say, (output) => chooser.name(output));
const listener = makeListener((movement) => {
  say("saved", "");
  chooser.open(movement, findLayer());
});

find("by-doing").addEventListener("click", () => {
  trial.clear();
  if (listener.waits) {
    stopListening();
    return;
  }
  pausing = newest !== null;
  if (pausing) page.send(PAUSE);
  doing = true;
  listener.start();
  placeGel();
  if (hasGel()) {
    find("gesture-buttons").open = true;
    find("by-doing").scrollIntoView();
    find("gel").focus({ preventScroll: true });
  }
  find("by-doing").textContent = "Cancel";
  find("measure").disabled = true;
  say("saved", "Make the movement on the gel, and lift your fingers. The gamepad is paused meanwhile.");
});

document.addEventListener("keydown", (event) => {
  if (event.key === "Escape" && listener.waits) stopListening();
});

// What was about to be bound, or the binding to be changed, is not the one that was shown.
function giveUp() {
  chooser.close();
  say("saved", "The profile has changed meanwhile, so nothing was saved. Begin again.");
}

function stopListening() {
  listener.stop();
  say("saved", "");
  endListening();
}

function endListening() {
  find("by-doing").textContent = "Make a movement to change it";
  if (pausing) page.send({ do: "resume", for: "movement" }); // what a person has stopped stays
  const hadFocus = find("doing").contains(document.activeElement);
  doing = pausing = false;
  showAll();
  if (hadFocus) find("by-doing").focus(); // the gel has gone back to its place
}

const findShown = () => profiles.view || about || {};

function findLayer() {
  return (findShown().layers || []).find((each) => each.name === layer);
}

function showLayer() {
  const { layers = [], edit, fault } = findShown();
  find("cards").hidden = !isKnown || Boolean(fault); // of a broken profile nothing is known
  if (!layers.some((each) => each.name === layer)) layer = layers.length ? layers[0].name : "";
  showOptions(find("layer-choice"), layers.map(({ name }) => [name, name]));
  find("layer-choice").value = layer;
  for (const id of ["layer-choice", "layer-label"]) find(id).hidden = layers.length < 2;
  // New buttons must not lose the focus: it goes to the same place, or to its card.
  const { place } = document.activeElement ? document.activeElement.dataset : {};
  cards.show(findLayer(), findShown(), Boolean(edit));
  find("undo").hidden = Boolean(profiles.view); // it is of the one that plays
  if (place) {
    const listed = [...document.querySelectorAll("#cards button")];
    const same = (wanted) => listed.find((each) => each.dataset.place === wanted);
    (same(place) || same(`${place.split(" ")[0]} add`)).focus();
  }
  showAll();
}

find("layer-choice").addEventListener("change", () => {
  layer = find("layer-choice").value;
  showLayer();
});
const showUndo = makeUndo(find("undo"), "There is no change to undo.",
  () => ask({ do: "undo" }, "saved"), page.tell);

const profiles = makeProfiles(find, {
  say,
  look: (name) => page.send({ do: "profile", profile: name }),
  changed: showLayer,
});
let copies = 0; // the number of the request for a copy, which plays then
find("profile").addEventListener("submit", (event) => {
  event.preventDefault();
  ask({ do: "use", profile: profiles.name }, "saved");
});
find("profile-copy").addEventListener("click", () => {
  copies = ask({ do: "copy", profile: profiles.name }, "saved");
});

// 3 Your range

const calibration = makeCalibration(find, (text) =>
  ask({ do: "answer", what: "calibrate", text }, "range-said"));
find("measure").addEventListener("click", () => {
  calibration.begin();
  find("answers").querySelector("button").focus(); // the button that had the focus is gone
  ask({ do: "start", what: "calibrate" }, "range-said");
  showAll();
  find("measuring").scrollIntoView(); // the question and the gel

});
const showRangeUndo = makeUndo(find("range-undo"), "There is no measurement to undo.",
  () => ask({ do: "undo calibration" }, "range-said"), page.tell);

// 4 How it helps you

const showOwn = makeOwnValues(find("own"), (name, value) => askOwn({ do: "own value", name, value }));
const askOwn = (request) => ask(request, "own-said");
const showOwnUndo = makeUndo(find("own-undo"), "There is no choice to undo.",
  () => askOwn({ do: "undo own values" }), page.tell);
find("own-mend").addEventListener("click", () => {
  askOwn({ do: "mend own values" });
  find("own-undo").focus();
});

// Help

const check = makeCheck(find, say);
find("check").addEventListener("click", () => {
  ask({ do: "start", what: "check" }, "check-state");
  check.begin();
});

const showRemote = makeRemote(find, say, ask);

showAll();
requestAnimationFrame(turn);
