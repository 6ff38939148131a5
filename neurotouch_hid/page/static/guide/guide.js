// The page of a command in the terminal: what it asks for, how far it is, and what it says.
//
// The server sends all values whenever one has changed. What is new is also told to screen readers.

import { makeSpeech } from "../shared/speech.js";
import { connect, element } from "../shared/wire.js";

const part = (id) => document.getElementById(id);
const speech = makeSpeech(part("live"));
let before = {};

const wire = connect(0, [{
  shown(now, { number }) {
    show(now);
    before = now;
    if (now.ended) wire.end();
    wire.send({ seen: number });
  },
  refused: (sentence) => notice(sentence),
  lost(sentence) {
    if (!before.ended) notice(sentence);
  },
}]);

function show(now) {
  notice("");
  document.title = now.title;
  part("title").textContent = now.title;
  part("simulated").textContent = now.simulated ? "SIMULATED" : "";
  const end = now.problem || "This is the end. You can close this page.";
  write("request", now.ended ? end : now.request);
  write("missing", now.ended ? "" : now.missing ?? "");
  part("progress-row").hidden = !now.n_requests || now.ended === true;
  if (now.n_requests) {
    part("progress").max = now.n_requests;
    part("progress").value = now.n_done;
    part("progress").textContent = `${now.n_done} of ${now.n_requests}`;
  }
  showKeys(now);
  showRows("score", now.score, before.score);
  showRows("results", now.results, before.results);
  showHeard(now.heard ?? []);
  announce(now);
}

function write(id, text) {
  if (part(id).textContent !== text) part(id).textContent = text;
}

function showKeys({ keys, ended }) {
  const row = part("keys");
  row.hidden = ended === true || !keys.length;
  if (row.children.length === keys.length) return; // a button keeps its focus
  row.replaceChildren(...keys.map(([key, label], k) => {
    const button = element("button", { type: "button", text: label, id: `key-${k}` });
    if (k === 0) button.className = "primary";
    button.addEventListener("click", () => wire.send({ press: key }));
    return button;
  }));
  if (keys.length) row.firstChild.focus();
}

function showRows(id, rows, old) {
  part(`${id}-part`).hidden = !rows?.length;
  if (!rows || JSON.stringify(rows) === JSON.stringify(old)) return;
  part(id).replaceChildren(...rows.map(({ word, name, sentence, fix }) => {
    const line = element("li", {}, element("span", { class: "word", text: word }),
      `${name ? `${name}: ` : ""}${sentence}`);
    if (fix) line.append(element("span", { class: "fix", text: fix }));
    return line;
  }));
}

function showHeard(heard) {
  part("heard-part").hidden = !heard.length;
  const list = part("heard");
  const first = heard.length ? heard[0][0] : 0;
  while (list.firstChild && Number(list.firstChild.value) < first) list.firstChild.remove();
  const last = list.lastChild ? list.lastChild.value : -1;
  for (const [number, sentence] of heard) {
    if (number > last) list.append(element("li", { value: number, text: sentence }));
  }
}

// A request and a sentence are told in their order; of a score that changes all the time, only what
// comes first, when it is another.
function announce(now) {
  const last = before.heard?.length ? before.heard[before.heard.length - 1][0] : -1;
  for (const [number, sentence] of now.heard ?? []) if (number > last) speech.tell(sentence);
  if (now.missing && now.missing !== before.missing) speech.say(now.missing);
  if (!now.heard && now.request !== before.request) speech.say(now.request);
  if (now.ended && !before.ended) speech.tell(now.problem || "This is the end.");
}

function notice(sentence) {
  if (sentence === part("notice").textContent) return; // a lost connection is told every second
  part("notice").textContent = sentence;
  part("notice").hidden = !sentence;
  if (sentence) speech.tell(sentence);
}
