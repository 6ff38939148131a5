// The page to label a recording: what the recogniser proposes, what a person makes of it.
//
// The server has the labels, and saves each change before it says so. This page only shows them,
// and asks for changes of the gesture at the present moment, or of the part that was marked.

import { readKey } from "../shared/presses.js";
import { makeSpeech } from "../shared/speech.js";
import { connect, element } from "../shared/wire.js";
import { MIDDLE, makePicture } from "./picture.js";
import { makeTimeline } from "./timeline.js";

const NAMES = ["No gesture", "Push", "Pinch", "Zoom", "Clockwise twist", "Counter-clockwise twist"];
const WITHOUT = "-";
const MOST_CONTACTS = 3;
const part = (id) => document.getElementById(id);
const speech = makeSpeech(part("live"));

let recording = null;
let sheet = null;
let k = 0;
let begin = null; // of the marked part
let end = null;
let timer = 0;
let asked = -1; // the moment that was asked for last

const wire = connect(0, [{
  hello(_, { recording: told }) {
    const isNew = recording === null;
    recording = told;
    const origin = told.simulated ? "SIMULATED: " : "";
    part("recording").textContent = `${origin}${told.name} → ${told.file}`;
    part("difference").hidden = told.others === null;
    notice("");
    if (isNew) makeTypes();
    timeline.begin(told);
    asked = -1;
    go(k);
  },
  sheet(told) {
    sheet = told;
    showSheet();
    asked = -1;
    ask();
  },
  moment(told) {
    if (told.k === k) picture.show(told, `The gel at ${seconds(k)} seconds`);
  },
  saved(sentence) {
    part("saved").textContent = "Saved";
    notice("");
    speech.say(`${sentence} ${describe()}`);
  },
  refused(sentence) {
    if (sheet) part("saved").textContent = "";
    notice(sentence);
  },
  lost: (sentence) => notice(sentence),
}]);

const timeline = makeTimeline({
  whole: part("whole"), near: part("near"), bar: part("time"),
  go: (to) => { pause(); go(to); },
  // The end of a label was dragged: the gesture reaches to another moment.
  reach: (first, last, kind) => change({ do: "type", first, last, kind: recording.kinds[kind] }),
});

const picture = makePicture(part, {
  grasp: pause,
  move: (at, index, [x, y]) => change({ do: "move", k: at, index, x, y }),
  remove,
});

function notice(sentence) {
  if (sentence === part("notice").textContent) return; // a lost connection is told every second
  part("notice").textContent = sentence;
  part("notice").hidden = !sentence;
  speech.tell(sentence);
}

function change(message) {
  part("saved").textContent = "Saving";
  wire.ask(message);
}

const last = () => recording.times_ms.length - 1;
const seconds = (at) => (recording.times_ms[at] / 1000).toFixed(2);

function go(to) {
  if (!recording) return;
  k = Math.max(0, Math.min(last(), to));
  ask();
  showPlace();
}

function ask() {
  if (!recording || asked === k) return;
  asked = k;
  wire.send({ do: "show", k });
}

// The moments that a change concerns: the marked part, or the gesture around the present moment.
function find() {
  if (begin !== null || end !== null) {
    const ends = [begin ?? k, end ?? k].sort((a, b) => a - b);
    return { first: ends[0], last: ends[1], isMarked: true };
  }
  const same = (at) => sheet.kinds[at] === sheet.kinds[k]
    && (sheet.kinds[k] !== WITHOUT || recording.proposals[at] === recording.proposals[k]);
  let [first, until] = [k, k];
  while (first > 0 && same(first - 1)) first -= 1;
  while (until < last() && same(until + 1)) until += 1;
  return { first, last: until, isMarked: false };
}

const kindAt = (at) => Number(sheet.kinds[at] === WITHOUT ? recording.proposals[at] : sheet.kinds[at]);

const countAt = (at) =>
  Number((sheet.kinds[at] === WITHOUT ? recording.proposed_counts : sheet.counts)[at]);

function describe() {
  if (!sheet || !recording) return "";
  const isLabelled = sheet.kinds[k] !== WITHOUT;
  const kind = kindAt(k);
  const count = countAt(k);
  const contacts = kind ? `, ${count} contact${count === 1 ? "" : "s"}` : "";
  return `${NAMES[kind]}${contacts}, ${isLabelled ? "confirmed" : "proposed"}.`;
}

function showPlace() {
  if (!sheet) return;
  const { first, last: until, isMarked } = find();
  part("moment").textContent = `${seconds(k)} s of ${seconds(last())} s`;
  part("what").textContent = describe();
  part("selection").textContent = isMarked
    ? `Marked: ${seconds(first)} to ${seconds(until)} s. Escape ends it.`
    : `From ${seconds(first)} to ${seconds(until)} s.`;
  const doubt = recording.doubts.find(([at]) => first <= at && at <= until);
  part("why").textContent = doubt ? `Doubt: ${doubt[1]}` : "";
  for (const [i, button] of [...part("types").children].entries()) {
    button.setAttribute("aria-pressed", String(i === kindAt(k)));
  }
  const bar = part("time");
  bar.setAttribute("aria-valuemax", String(last()));
  bar.setAttribute("aria-valuenow", String(k));
  bar.setAttribute("aria-valuetext", `${seconds(k)} seconds. ${describe()}`);
  timeline.show({ k, sheet, first, last: until, isMarked });
}

function showSheet() {
  const n = [...sheet.kinds].filter((kind) => kind !== WITHOUT).length;
  part("progress").textContent =
    `${Math.floor((100 * n) / sheet.kinds.length)} % of ${sheet.kinds.length} moments have a label.`;
  part("undo").setAttribute("aria-disabled", String(!sheet.can_undo));
  part("redo").setAttribute("aria-disabled", String(!sheet.can_redo));
  const { agreement, differences } = sheet;
  part("agreement").textContent = agreement
    ? `With ${recording.other}: ${agreement.kappa === null ? "" : `kappa ${agreement.kappa.toFixed(2)}, `}`
      + `same type ${(100 * agreement.same_type).toFixed(1)} %, ${differences.length} differences.`
    : "";
  showPlace();
}

function remove(index) {
  change({ do: "remove", k, index });
}

function removeChosen() {
  const chosen = document.activeElement?.dataset?.index;
  remove(chosen === undefined ? countAt(k) - 1 : Number(chosen));
}

function add(place) {
  if (countAt(k) < MOST_CONTACTS) {
    const [x, y] = place ?? MIDDLE;
    change({ do: "add", k, x, y });
  } else {
    notice(`A gesture has at most ${MOST_CONTACTS} contacts.`);
  }
}

function setType(kind) {
  const { first, last: until } = find();
  change({ do: "type", first, last: until, kind: recording.kinds[kind] });
  mark(null, null);
}

function confirm() {
  const { first, last: until } = find();
  change({ do: "confirm", first, last: until });
  mark(null, null);
}

function clear() {
  const { first, last: until } = find();
  change({ do: "clear", first, last: until });
  mark(null, null);
}

function mark(from, to) {
  [begin, end] = [from, to];
  showPlace();
}

// Goes to the next of some moments, or back; says so where there is none.
function goAlong(moments, isBack, words) {
  const found = isBack ? moments.filter((at) => at < k).at(-1) : moments.find((at) => at > k);
  if (found === undefined) {
    speech.tell(words);
    part("why").textContent = words;
    return;
  }
  pause();
  go(found);
  speech.say(`${seconds(k)} seconds. ${describe()} ${part("why").textContent}`);
}

const goToDoubt = (isBack) => goAlong(
  recording.doubts.map(([at]) => at).filter((at) => sheet.kinds[at] === WITHOUT),
  isBack, "No further doubt.");

function goToOpen(isBack) {
  const starts = [...sheet.kinds].map((kind, at) => at).filter((at) => sheet.kinds[at] === WITHOUT
    && (at === 0 || sheet.kinds[at - 1] !== WITHOUT
      || recording.proposals[at] !== recording.proposals[at - 1]));
  goAlong(starts, isBack, "All moments after this one have a label.");
}

// The middle of each gesture, as labelled or proposed.
function goToGesture(isBack) {
  const middles = [];
  for (let at = 0; at <= last();) {
    let until = at;
    while (until < last() && kindAt(until + 1) === kindAt(at)) until += 1;
    if (kindAt(at)) middles.push((at + until) >> 1);
    at = until + 1;
  }
  goAlong(middles, isBack, "No further gesture.");
}

const goToDifference = (isBack) =>
  goAlong(sheet.differences ?? [], isBack, "No further difference.");

function play() {
  if (timer) return pause();
  const [started, from] = [performance.now(), recording.times_ms[k === last() ? 0 : k]];
  if (k === last()) go(0);
  part("play").setAttribute("aria-pressed", "true");
  timer = setInterval(() => {
    const now = from + performance.now() - started;
    let at = k;
    while (at < last() && recording.times_ms[at + 1] <= now) at += 1;
    if (at !== k) go(at);
    if (at === last()) pause();
  }, 20);
}

function pause() {
  clearInterval(timer);
  timer = 0;
  part("play").setAttribute("aria-pressed", "false");
}

function makeTypes() {
  part("types").replaceChildren(...NAMES.map((name, i) => {
    const button = element("button", { type: "button", "aria-pressed": "false" },
      element("span", { class: `swatch kind-${i}`, "aria-hidden": "true" }), name,
      element("kbd", { text: String(i), "aria-hidden": "true" }));
    button.addEventListener("click", () => setType(i));
    return button;
  }));
  part("legend").replaceChildren(...NAMES.map((name, i) => element("span", {},
    element("span", { class: `swatch kind-${i}` }), name)));
}

for (const [id, act] of Object.entries({
  confirm, play, undo: () => change({ do: "undo" }), redo: () => change({ do: "redo" }),
  add: () => add(), remove: removeChosen, doubt: () => goToDoubt(false),
  gesture: () => goToGesture(false), open: () => goToOpen(false), difference: () => goToDifference(false),
  "confirm-rest": () => change({ do: "confirm_rest" }),
})) {
  part(id).addEventListener("click", () => { if (sheet) act(); });
}
// The chosen contact keeps the focus, so that Remove knows which is meant.
part("remove").addEventListener("pointerdown", (event) => event.preventDefault());
part("stage").addEventListener("dblclick", (event) => {
  if (sheet && !event.target.closest("button")) add(picture.findPlace(event));
});

const LETTERS = {
  c: () => add(), d: (isBack) => goToDoubt(isBack), l: (isBack) => goToOpen(isBack),
  f: (isBack) => goToDifference(isBack), g: (isBack) => goToGesture(isBack), a: () => change({ do: "confirm_rest" }),
  "[": () => mark(k, end), "]": () => mark(begin, k),
};

addEventListener("keydown", (event) => {
  if (!sheet || event.altKey || event.metaKey) return;
  const key = readKey(event);
  let act = null;
  if (event.ctrlKey) {
    if (key === "z") act = () => change({ do: event.shiftKey ? "redo" : "undo" });
    if (key === "y") act = () => change({ do: "redo" });
  } else if (event.target.matches("input, summary")) {
    return;
  } else {
    const far = event.shiftKey ? 10 : 1;
    const isButton = event.target.matches("button") && !event.target.dataset.index;
    act = {
      ArrowLeft: () => { pause(); go(k - far); },
      ArrowRight: () => { pause(); go(k + far); },
      Home: () => { pause(); go(0); },
      End: () => { pause(); go(last()); },
      Escape: () => mark(null, null),
      Backspace: clear,
      Delete: removeChosen,
      ...(isButton ? {} : { Enter: confirm, " ": play }),
    }[key];
    if (!act && part("keys").checked) {
      if (/^[0-5]$/.test(key)) act = () => setType(Number(key));
      else if (LETTERS[key]) act = () => LETTERS[key](event.shiftKey);
    }
  }
  if (!act) return;
  event.preventDefault();
  act();
});
addEventListener("resize", () => { if (sheet) showPlace(); });
