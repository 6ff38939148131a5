// The first page: leads from any state to playing, without a terminal.

import { MOUSE, makeGel, makeGestureButtons } from "../gel/pressed_gel.js";
import { openPage } from "../shared/header.js";
import { makeUndo } from "../shared/undo.js";
import { element } from "../shared/wire.js";
import { makeCalibration } from "./calibration.js";
import { makeCheck } from "./check.js";
import { makeChooser } from "./chooser.js";
import { makeCards, makeListener } from "./movements.js";
import { makeOwnValues } from "./own_values.js";
import { makeProfiles } from "./profiles.js";
import { makeRemote } from "./remote.js";
import { makeTrial } from "./trial.js";

const HZ = 30;
const PICTURE_MS = 1000;
const FAULT = /^(Error|Fix|Warning|No real)/;
const EDITS = ["check", "remote", "undo", "profile-use", "profile-copy", "range-undo", "own-undo"];
const PAUSE = { do: "pause", for: "movement" }; // which ends with this page
const STARTING = "The first start on a machine takes up to a minute.";
const ADVICE = { // where the page can do nothing
  no_camera: "Plug the camera in, or try everything with the mouse first.",
  no_right: "You may not use the camera yet. Once, in a terminal: neurotouch setup",
  no_pad: "No game sees what you do yet. Once, in a terminal: neurotouch setup",
  service_stopped: "An administrator starts it: sudo systemctl start neurotouch",
  unusable: "See below: Check this machine.",
  no_data: "Look at its cable, or try everything with the mouse first.",
  ready: "Keep your hand off the gel until the dots are found.",
};

const STARTS = { camera: "camera", events: "camera", webcam: "webcam" };
const MENDS = { setup: "Give me the right", service: "Start the service" };
const LOOKING = "Looking …";
const WEBCAM = "If it looks at a gel, start with it. If not, try everything with the mouse first.";
const PASSWORD = "This computer then asks for the password of an administrator.";

const find = (id) => document.getElementById(id);
let mayEdit = false;
const places = new Map(); // where the answer to a request is said
let refusal = ""; // the place of the last one
let about = null;
let kept = {}; // how far an unfinished measurement is, of a hand and of a simulated one
let newest = null;
let situation = null;
let plugged = ""; // a camera that could play in place of a simulated gel
let runs = false;
let starting = "";
let isLost = false; // there is no connection, so nothing is known
let replaces = false; // a camera's driver takes the place of one with a simulated gel
let begun = false; // this page started the driver
let ended = false; // this page ends it
let faults = []; // errors of a failed start
let isKnown = false; // the outputs have come
let layer = "";
let doing = false; // a movement is waited for, or its output is chosen
let fresh = false; // the driver is paused for it

const page = openPage(HZ, {
  places,
  hello(_, { edit, far }) {
    isLost = false;
    page.send({ do: "profiles" });
    page.send({ do: "outputs" });
    for (const id of EDITS) find(id).disabled = !edit;
    find("far").hidden = !far;
    mayEdit = edit;
    calibration.reset();
    if (fresh) page.send(PAUSE); // the connection was lost, and the driver has gone on
  },
  state(state) {
    isLost = false;
    if (replaces) return; // the last ones of the driver that ends
    const first = newest === null;
    newest = state;
    if (starting) sayStart(faults.join(" "));
    [runs, starting] = [true, ""];
    profiles.setPlayed(state.profile);
    cards.mark(state.gesture.movement);
    // A movement before the driver has paused still moves the gamepad, and chooses nothing.
    if (state.state !== "running") listener.hear(state.gesture);
    trial.hear(state, performance.now());
    if (first || state.slow !== shownSlow) showStart();
    if (!layer && state.layer) showLayer();
  },
  driver(is) {
    isLost = false;
    runs = is;
    if (!is) {
      replaces = false;
      lose();
    }
    showStart();
  },
  situation(found) { // told while nothing comes
    situation = found;
    lose();
    showStart();
  },
  plugged(found) {
    plugged = found;
    if (plugged) page.tell(`A ${STARTS[plugged]} is plugged in.`);
    showStart();
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
    isLost = true;
    calibration.lose();
    showStart();
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
    if (refusal === "range-said" && !isLost) calibration.reset();
    if (refusal === "start-lines") [starting, replaces] = ["", false];
    (refusal === "start-lines" ? sayStart : (text) => say(refusal, text))(sentence);
    showStart();
  },
  picture: (address) => { find("picture").src = address; find("picture").hidden = false; },
  program: hearProgram,
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
  fresh = false; // there is no driver to resume
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

let shownSlow = null;
function showStart() {
  shownSlow = newest ? newest.slow : null;
  const isMouse = hasGel();
  for (const id of ["gel", "gesture-buttons"]) find(id).hidden = !isMouse;
  const isSimulated = newest && newest.slow.simulated;
  const isGel = newest && newest.gel.found;
  let [words, advice] = [LOOKING, ""];
  if (isLost) {
    words = "Not connected.";
  } else if (starting) {
    words = "Starting …";
  } else if (newest && !isGel) {
    // The header has the reason.
    [words, advice] = [`The gel is ${newest.gel.text.split(":")[0]}.`, newest.gel.fix];
  } else if (isMouse) {
    [words, advice] = ["The mouse presses a simulated gel.", "Drag on the gel below, turn the " +
      "wheel, or use the arrow keys, Q, E, plus and minus."];
  } else if (isSimulated) {
    [words, advice] = ["A simulated hand plays.", "You can try everything on this page with it."];
  } else if (newest) {
    [words, advice] = ["Ready to play.", `Every game sees the gamepad: ${newest.slow.device}.`];
  } else if (situation) {
    const isReady = situation.kind === "ready" && situation.start === "camera";
    [words, advice] = [isReady ? "The camera is ready." : situation.text,
      situation.mend ? PASSWORD : situation.start === "webcam" ? WEBCAM : ADVICE[situation.kind]];
  }
  const before = find("situation").textContent;
  const isNews = before !== words && !isLost; // that the connection is lost, the header says
  if (isNews && newest) page.say(words);
  else if (isNews && situation && !starting && before !== LOOKING) page.tell(words);
  say("situation", words);
  say("advice", advice);
  const isIdle = !newest && !starting && situation !== null;
  const startable = isIdle ? situation.start : isSimulated ? plugged : "";
  const hadFocus = document.activeElement === find("start-camera");
  find("start-camera").hidden = !startable;
  if (startable) {
    say("start-camera", isIdle ? `Start with the ${STARTS[startable]}`
      : `Play with the ${STARTS[startable]} instead`);
    find("start-camera").dataset.what = startable;
  }
  find("mend").hidden = !(isIdle && situation.mend);
  if (isIdle && situation.mend) say("mend", MENDS[situation.mend]);
  find("start-mouse").hidden = !isIdle;
  if (hadFocus && !startable && isIdle) find("start-mouse").focus(); // the camera was unplugged
  find("fly").hidden = !newest;
  find("press").hidden = !isMouse;
  find("look").hidden = !newest;
  find("end").hidden = !runs;
  // The button that started it is gone, and the focus too.
  if (newest && begun && document.activeElement === document.body) find("fly").focus();
  if (newest) begun = false;
  if (ended && isIdle) {
    const next = ["start-camera", "mend", "start-mouse"].map(find).find((each) => !each.hidden);
    if (next && document.activeElement === document.body) next.focus();
    ended = false;
  }
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
  if (find(id).textContent !== text) find(id).textContent = text;
}

// Announced once: a screen reader would read a live region again whenever a dialog closes.
function sayStart(text) {
  if (find("start-lines").textContent !== text) page.tell(text);
  say("start-lines", text);
}

function start(what) {
  replaces = newest !== null;
  starting = what;
  begun = true;
  faults = [];
  ask({ do: "start", what, ...(replaces ? { instead: true } : {}) }, "start-lines");
  lose();
  sayStart(STARTING);
  showStart();
}

find("start-camera").addEventListener("click", () => start(find("start-camera").dataset.what));
find("start-mouse").addEventListener("click", () => start("mouse"));
find("mend").addEventListener("click", () => {
  faults = [];
  ask({ do: "start", what: situation.mend }, "start-lines");
  sayStart("Asking for the password …");
});
find("end").addEventListener("click", () => {
  [faults, ended] = [[], true]; // what its start said is over
  ask({ do: "stop", what: "driver" }, "start-lines");
});
let looks = 0;
find("look").addEventListener("click", () => {
  clearInterval(looks);
  looks = looks ? 0 : setInterval(() => page.send({ do: "picture" }), PICTURE_MS);
  if (looks) page.send({ do: "picture" });
  find("picture").hidden = true;
  find("look").textContent = looks ? "Hide the picture" : "Show the camera's picture";
});

function hearProgram(news) {
  if (news.name === "check") return check.hear(news);
  if (news.name === "calibrate") {
    calibration.hear(news);
    return showStart();
  }
  if ("line" in news) {
    if (FAULT.test(news.line)) faults.push(news.line);
    if (faults.length) sayStart(faults.join(" "));
    return;
  }
  if (news.name in MENDS && news.code && !faults.length) faults = ["Nothing was changed."];
  starting = "";
  sayStart(faults.join(" "));
  return showStart();
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
  fresh = newest !== null && newest.state === "running";
  if (fresh) page.send(PAUSE);
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
  if (fresh) page.send({ do: "resume" });
  const hadFocus = find("doing").contains(document.activeElement);
  doing = fresh = false;
  showStart();
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
  find("layer-choice").replaceChildren(...layers.map(({ name }) =>
    element("option", { value: name, text: name })));
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
  showStart();
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
  showStart();
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

showStart();
requestAnimationFrame(turn);
