// The first page: leads from any state to playing, without a terminal.

import { MOUSE, makeGel, makeGestureButtons } from "../gel/pressed_gel.js";
import { openPage } from "../shared/header.js";
import { element } from "../shared/wire.js";
import { makeCalibration } from "./calibration.js";
import { makeCheck } from "./check.js";
import { makeChooser } from "./chooser.js";
import { makeCards, makeListener } from "./movements.js";
import { makeOwnValues } from "./own_values.js";

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

const MENDS = { setup: "Give me the right", service: "Start the service" };
const PASSWORD = "This computer then asks for the password of an administrator.";

const find = (id) => document.getElementById(id);
let mayEdit = false;
const places = new Map(); // where the answer to a request is said
let about = null;
let kept = {}; // how far an unfinished measurement is, of a hand and of a simulated one
let newest = null;
let situation = null;
let runs = false;
let starting = "";
let begun = false; // this page started the driver
let faults = []; // errors of a failed start
let layer = "";
let fresh = false; // the page waits for a movement, and has paused the driver for it

const page = openPage(HZ, {
  hello(_, { edit, far }) {
    page.send({ do: "profiles" });
    page.send({ do: "outputs" });
    for (const id of EDITS) find(id).disabled = !edit;
    find("far").hidden = !far;
    mayEdit = edit;
    calibration.reset();
    if (fresh) page.send(PAUSE); // the connection was lost, and the driver has gone on
  },
  state(state) {
    const before = newest;
    const first = before === null;
    newest = state;
    if (starting) sayStart(faults.join(" "));
    [runs, starting] = [true, ""];
    if (!first && state.profile !== before.profile) showProfiles(profiles);
    cards.mark(state.gesture.movement);
    listener.hear(state.gesture);
    if (first || state.slow !== shownSlow) showStart();
    if (!layer && state.layer) showLayer();
  },
  driver(is) {
    runs = is;
    if (!is) newest = null;
    showStart();
  },
  situation(found) { // told while nothing comes
    [situation, newest] = [found, null];
    showStart();
  },
  about(message) {
    const isFirst = about === null;
    about = message;
    showLayer();
    if (!isFirst) page.send({ do: "profiles" });
  },
  outputs(groups) {
    chooser.setOutputs(groups);
    showLayer();
  },
  profiles: showProfiles,
  own(found) {
    const { fault, values, unfinished = {} } = found;
    kept = unfinished;
    showRange();
    showOwn(values, mayEdit);
    page.notice("own", fault ? `${fault} Below, 'Mend my values' brings back what could be read.` : "");
    find("own-mend").hidden = !(fault && mayEdit);
  },
  lost: () => {
    calibration.lose();
    showStart();
  },
  saved(sentence, { n }) { if (sentence) say(places.get(n) || "saved", sentence); },
  refused() {
    if (starting) sayStart("");
    starting = "";
    showStart();
  },
  picture: (address) => { find("picture").src = address; find("picture").hidden = false; },
  program: hearProgram,
  remote: showRemote,
});

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
  let [words, advice] = ["Looking …", ""];
  if (starting) {
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
    [words, advice] = [situation.kind === "ready" ? "The camera is ready." : situation.text,
      situation.mend ? PASSWORD : ADVICE[situation.kind]];
  }
  if (find("situation").textContent !== words && newest) page.say(words);
  say("situation", words);
  say("advice", advice);
  const isIdle = !newest && !starting && situation !== null;
  find("start-camera").hidden = runs || !(isIdle && situation.kind === "ready");
  find("mend").hidden = !(isIdle && situation.mend);
  if (isIdle && situation.mend) say("mend", MENDS[situation.mend]);
  find("start-mouse").hidden = !isIdle;
  find("fly").hidden = !newest;
  find("press").hidden = !isMouse;
  find("look").hidden = !newest;
  find("end").hidden = !runs;
  // The button that started it is gone, and the focus too.
  if (newest && begun && document.activeElement === document.body) find("fly").focus();
  if (newest) begun = false;
  find("by-doing").hidden = !(newest && about && about.edit);
  find("by-doing").disabled = calibration.runs; // both listen to the same movements
  placeGel();
  find("measure").disabled = !newest || !mayEdit || listener.waits;
  showRange();
}

// Beside the question that it answers: nobody scrolls between the two.
function placeGel() {
  const place = find(calibration.runs ? "measuring" : "start-gel");
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
  starting = what;
  begun = true;
  faults = [];
  sayStart(STARTING);
  page.send({ do: "start", what });
  showStart();
}

find("start-camera").addEventListener("click", () => start("camera"));
find("start-mouse").addEventListener("click", () => start("mouse"));
find("mend").addEventListener("click", () => {
  faults = [];
  sayStart("Asking for the password …");
  page.send({ do: "start", what: situation.mend });
});
find("end").addEventListener("click", () => page.send({ do: "stop", what: "driver" }));
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
  remove: (binding) => page.send({ do: "unbind", key: binding.key }),
  name: (output) => chooser.name(output),
});
const chooser = makeChooser(find("chooser"), {
  bind: (wish) => page.send({ do: "bind", layer, ...wish }),
  closed: endListening,
});
const listener = makeListener((movement) => {
  say("saved", "");
  chooser.open(movement, findLayer());
});

find("by-doing").addEventListener("click", () => {
  if (listener.waits) {
    listener.stop();
    endListening();
    return;
  }
  fresh = newest !== null && newest.state === "running";
  if (fresh) page.send(PAUSE);
  listener.start();
  if (hasGel()) {
    find("gesture-buttons").open = true;
    find("gel").focus();
  }
  find("by-doing").textContent = "Cancel";
  find("measure").disabled = true;
  say("saved", "Make the movement on the gel, and lift your fingers. The gamepad is paused meanwhile.");
});

function endListening() {
  find("by-doing").textContent = "Make a movement to change it";
  if (fresh) page.send({ do: "resume" });
  fresh = false;
  showStart();
}

function findLayer() {
  return about && about.layers ? about.layers.find((each) => each.name === layer) : null;
}

function showLayer() {
  const layers = about && about.layers ? about.layers : [];
  if (!layers.some((each) => each.name === layer)) layer = layers.length ? layers[0].name : "";
  find("layer-choice").replaceChildren(...layers.map(({ name }) =>
    element("option", { value: name, text: name })));
  find("layer-choice").value = layer;
  for (const id of ["layer-choice", "layer-label"]) find(id).hidden = layers.length < 2;
  // New buttons must not lose the focus: it goes to the same place, or to its card.
  const { place } = document.activeElement ? document.activeElement.dataset : {};
  cards.show(findLayer(), Boolean(about && about.edit));
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
find("undo").addEventListener("click", () => page.send({ do: "undo" }));

let profiles = [];
let chosen = ""; // in the list, and not in use yet
function showProfiles(found) {
  profiles = found;
  const select = find("profile-choice");
  select.replaceChildren(...found.map(({ name, own }) => element("option", { value: name,
    text: own ? `${name} (yours)` : name })));
  const active = newest ? newest.profile : (found.find(({ first }) => first) || {}).name;
  const names = found.map(({ name }) => name);
  select.value = [chosen, active].find((name) => names.includes(name)) || names[0] || "";
  tellProfile();
}

function tellProfile() {
  const found = profiles.find(({ name }) => name === find("profile-choice").value);
  say("profile-about", found ? found.about : "");
}

find("profile-choice").addEventListener("change", () => {
  chosen = find("profile-choice").value;
  tellProfile();
});
find("profile").addEventListener("submit", (event) => {
  event.preventDefault();
  page.send({ do: "use", profile: find("profile-choice").value });
  chosen = "";
});
find("profile-copy").addEventListener("click", () => {
  page.send({ do: "copy", profile: find("profile-choice").value });
  chosen = "";
});

// 3 Your range

const calibration = makeCalibration(find, (text) =>
  page.send({ do: "answer", what: "calibrate", text }));
find("measure").addEventListener("click", () => {
  calibration.begin();
  find("answers").querySelector("button").focus(); // the button that had the focus is gone
  page.send({ do: "start", what: "calibrate" });
  showStart();
});
find("range-undo").addEventListener("click", () =>
  places.set(page.ask({ do: "undo calibration" }), "range-said"));

// 4 How it helps you

const showOwn = makeOwnValues(find("own"), (name, value) => askOwn({ do: "own value", name, value }));
const askOwn = (request) => places.set(page.ask(request), "own-said");
find("own-undo").addEventListener("click", () => askOwn({ do: "undo own values" }));
find("own-mend").addEventListener("click", () => {
  askOwn({ do: "mend own values" });
  find("own-undo").focus();
});

// Help

const check = makeCheck(find, say);
find("check").addEventListener("click", () => {
  check.begin();
  page.send({ do: "start", what: "check" });
});

find("remote").addEventListener("click", () => {
  say("remote-state", "One moment …");
  page.send({ do: "remote" });
});
find("remote-end").addEventListener("click", () => page.send({ do: "stop", what: "remote" }));

function showRemote(found) {
  find("remote").hidden = Boolean(found);
  find("remote-end").hidden = !found;
  find("code").hidden = !found;
  if (found) find("code").src = found.code;
  say("remote-state", found ? `Scan this with the phone's camera. The access ends after ${found.minutes} minutes. ` +
    "What was started from the phone ends then, too."
    : "No phone is connected.");
  say("remote-link", found ? found.link : "");
}

showStart();
requestAnimationFrame(turn);
