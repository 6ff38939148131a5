// The header of every page: Pause or Resume, the driver's state, the other pages, speech and keys.
//
// A page has an empty <header> and calls `openPage` with its own handlers of the stream. The
// header hears each message first.

import { recall, remember } from "./memory.js";
import { readKey, watchPresses } from "./presses.js";
import { LEVELS, makeSpeech } from "./speech.js";
import { connect, element } from "./wire.js";

// The navigation of all pages. A new page is one more line.
const PAGES = [
  ["/", "Start"],
  ["/live", "Live view"],
  ["/gel", "Mouse gel"],
  ["/game", "Spacecraft"],
];
const STATES = {
  waiting: "Waiting for the driver",
  running: "Running",
  paused: "Paused: everything is released",
  panic: "Stopped by panic: everything is released",
  silent: "No data: everything is released",
  unheard: "Nothing arrives here: the driver may still play",
  none: "No driver is running",
  lost: "Not connected",
};
const PAUSE_KEY = "p";
const KEY_CHOICE = "neurotouch-pause-key";
const SILENT_MS = 3000; // a busy machine may be late by a second
const UNHEARD_MS = 6000; // the server says sooner whether the driver is silent
const NOTICES = ["request", "connection", "driver", "profile", "own"]; // the first one that applies shows

// Builds the header and connects. `handlers` are those of `connect`. Returns the page's
// functions to the server (`ask`, `send`), `say` and `tell` of its speech, and `notice(about,
// sentence)`; an empty sentence removes that notice.
export function openPage(hz, handlers, { gap_ms } = {}) {
  const parts = build(document.querySelector("header"));
  const speech = makeSpeech(parts.live, gap_ms);
  const notices = new Map();
  let wire = null;
  let shown = "waiting"; // of STATES
  let driver = "waiting"; // the driver's last state
  let runs = false;
  let asked = 0; // the number of the last Pause or Resume
  const isTwice = watchPresses();
  let mayPause = true;
  let heard = performance.now();
  let isSilent = false; // the driver sends nothing, as the server says
  let profile = null;
  let layer = null;
  let gel = null; // what is wrong with it, in a word

  function notice(about, sentence) {
    notices.set(about, sentence);
    const found = NOTICES.map((each) => notices.get(each)).find(Boolean) || "";
    if (found === parts.notice.textContent) return;
    parts.notice.textContent = found;
    parts.notice.hidden = !found;
    speech.tell(found);
  }

  function show(state) {
    if (state === shown) return;
    shown = state;
    showState();
    if (state !== "waiting") speech.tell(`${STATES[state]}.`);
  }

  function showState() {
    parts.word.textContent = resumes() ? "Resume" : "Pause";
    parts.state.textContent = STATES[shown];
    parts.state.dataset.state = shown;
    const reason = mayPause || !hasDriver() ? ""
      : "This page is read-only. To pause here: neurotouch view --edit";
    parts.reason.textContent = reason;
    parts.reason.hidden = !reason;
    parts.button.setAttribute("aria-disabled", String(isDisabled()));
  }

  const resumes = () => driver === "paused" || driver === "panic";
  const hasDriver = () => !["waiting", "none", "lost"].includes(shown);
  const isDisabled = () => !mayPause || !hasDriver();

  function pauseOrResume() {
    if (isDisabled()) {
      speech.tell(parts.reason.textContent || `${STATES[shown]}.`);
      return;
    }
    const mayResume = !isTwice();
    if (!resumes()) asked = wire.ask({ do: "pause" });
    else if (mayResume) asked = wire.ask({ do: "resume" });
  }

  function showWhat({ slow, profile: name, layer: of }) {
    const words = slow.simulated ? [element("strong", { class: "simulated", text: "SIMULATED" })]
      : slow.source ? [slow.source] : [];
    const key = JSON.stringify([slow.simulated, slow.source, name]);
    if (key !== parts.key) {
      parts.key = key;
      parts.badges.replaceChildren(...words, ` · profile ${name}`);
    }
    const news = [];
    if (profile !== null && name !== profile) news.push(`Profile ${name}.`);
    if (layer !== null && of !== layer && name === profile) news.push(`Layer ${of}.`);
    [profile, layer] = [name, of];
    if (news.length) speech.tell(news.join(" "));
  }

  function forgetWhat() {
    parts.key = "";
    parts.badges.replaceChildren();
  }

  // It is said once: numbers in its sentence may go on changing.
  function showGel({ found, problem, text, fix }) {
    const isFine = !problem || problem === "waiting";
    const words = isFine ? "" : `The gel is ${text}. ${fix}`;
    if (parts.gel.textContent !== words) parts.gel.textContent = words;
    parts.gel.hidden = isFine;
    const news = isFine ? "" : `${found} ${problem}`;
    if (news === gel) return;
    if (words) speech.tell(words);
    else if (gel) speech.tell("The gel is found.");
    gel = news;
  }

  const own = {
    hello(_, { edit }) {
      mayPause = edit;
      notice("connection", "");
      notice("request", "");
      if (shown === "lost") show("waiting");
      showState();
    },
    state(state) {
      [runs, isSilent] = [true, false];
      heard = performance.now();
      if (state.state !== driver) {
        driver = state.state;
        showState();
      }
      show(driver);
      showWhat(state);
      showGel(state.gel);
    },
    driver(is) {
      [runs, isSilent] = [is, false];
      heard = performance.now();
      if (!runs) {
        driver = "waiting";
        gel = null;
        parts.gel.hidden = true;
        forgetWhat();
        show("none");
        showState();
      } else if (shown === "none") {
        show("waiting");
      }
    },
    situation: () => { isSilent = runs; },
    about(message) {
      const { fault } = message || {};
      notice("profile", fault ? `The profile cannot be shown: ${fault}` : "");
    },
    // The refusal of an older request is obsolete. Only an answer that waits for data is shown.
    saved: (sentence, { n }) => notice("request", n === asked ? sentence : ""),
    // A page may have a place for it, beside the button that was pressed.
    refused(sentence, { n }) {
      if (!handlers.places?.has(n)) notice("request", sentence);
    },
    lost(sentence) {
      if (shown !== "lost") notice("request", ""); // it is told again with each attempt to connect
      show("lost");
      forgetWhat();
      notice("connection", sentence);
    },
  };

  wire = connect(hz, [own, handlers]);
  setInterval(() => {
    const late = performance.now() - heard > (isSilent ? SILENT_MS : UNHEARD_MS);
    if (late && runs && shown !== "lost") show(isSilent ? "silent" : "unheard");
  }, 500);

  parts.button.addEventListener("click", pauseOrResume);
  listenToKey(parts, pauseOrResume);
  parts.spoken.value = speech.level;
  parts.spoken.addEventListener("change", () => { speech.level = parts.spoken.value; });
  showState();
  return { ...wire, notice, say: speech.say, tell: speech.tell };
}

function build(header) {
  const word = element("span");
  const hint = element("kbd", { text: PAUSE_KEY.toUpperCase(), "aria-hidden": "true" });
  // The state is no part of its description: a screen reader would say each change twice, and the
  // older one last.
  const button = element("button", { type: "button", id: "pause-resume",
    "aria-describedby": "pause-reason" }, word, hint);
  const state = element("span", { id: "driver-state" });
  const reason = element("span", { id: "pause-reason", class: "aside" });
  const links = PAGES.map(([path, name]) => element("a", {
    href: path, "data-page": path, text: name,
    ...(path === location.pathname ? { "aria-current": "page" } : {}),
  }));
  const spoken = element("select", { id: "spoken" }, ...Object.keys(LEVELS).map((level) =>
    element("option", { value: level, text: level })));
  const key = element("input", { type: "checkbox", id: "pause-key" });
  const badges = element("p", { id: "badges", class: "badges" });
  const live = element("p", { id: "live", class: "unseen", role: "status", "aria-live": "polite" });
  const notice = element("p", { id: "notice", class: "notice" });
  notice.hidden = true;
  const gel = element("p", { id: "gel-problem", class: "notice" });
  gel.hidden = true;
  header.replaceChildren(
    element("p", { class: "brand", text: "NeuroTouch" }),
    element("p", { class: "driver" }, button, state, reason),
    element("nav", { "aria-label": "Pages" }, ...links),
    element("details", { id: "page-settings", class: "page-settings" },
      element("summary", { text: "Speech and keys" }),
      element("p", {}, element("label", { for: "spoken", text: "Spoken changes" }), spoken),
      element("p", {}, key, element("label", { for: "pause-key",
        text: `Key ${PAUSE_KEY.toUpperCase()} pauses and resumes` })),
      element("p", { class: "aside", text: "Important are state, profile, layer, refusals and "
        + "errors. This browser remembers both choices." })),
    badges, gel, notice, live,
  );
  return { button, word, hint, state, reason, spoken, key, badges, live, notice, gel };
}

// The key acts wherever the focus is, except in text fields. It can be switched off (WCAG 2.1.4),
// because speech input may produce single letters.
function listenToKey({ button, hint, key }, act) {
  const show = () => {
    hint.hidden = !key.checked;
    if (key.checked) button.setAttribute("aria-keyshortcuts", PAUSE_KEY.toUpperCase());
    else button.removeAttribute("aria-keyshortcuts");
  };
  key.checked = recall(KEY_CHOICE, "on") !== "off";
  key.addEventListener("change", () => {
    remember(KEY_CHOICE, key.checked ? "on" : "off");
    show();
  });
  show();
  addEventListener("keydown", (event) => {
    if (!key.checked || event.repeat || event.ctrlKey || event.altKey || event.metaKey) return;
    if (readKey(event) !== PAUSE_KEY || isTyping(event.target)) return;
    event.preventDefault();
    act();
  }, { capture: true });
}

const NO_TYPING = ["button", "checkbox", "color", "file", "image", "radio", "range", "reset",
  "submit"];

function isTyping(target) {
  if (!(target instanceof HTMLElement)) return false;
  if (target.closest("[data-takes-keys]")) return true;
  if (target.isContentEditable || target.matches("select, textarea")) return true;
  return target instanceof HTMLInputElement && !NO_TYPING.includes(target.type);
}
