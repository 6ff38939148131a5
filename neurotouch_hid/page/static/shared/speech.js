// Sends sentences to screen readers through one live region for the whole page.

import { recall, remember } from "./memory.js";

export const LEVELS = { all: "all", important: "important", none: "none" };
const KEY = "neurotouch-spoken";
const TOGETHER_MS = 100; // what comes at once is one sentence: a busy reader loses the first of two
const KEPT_MS = 5000; // a screen reader would read the sentence again whenever a dialog closes

// `say` is for frequent changes, `tell` for changes that a person must not miss: the driver's state,
// profile, layer, refusals and errors. A change of numbers alone makes no sentence.
export function makeSpeech(region, gap_ms = 1500) {
  let level = recall(KEY, LEVELS.all);
  if (!(level in LEVELS)) level = LEVELS.all;
  let shape = "";
  let newest = null;
  let waiting = []; // important sentences, in their order
  let due = 0;
  let timer = 0;
  let ends = 0; // the timer that takes the sentence away

  function plan() {
    if (timer || (!waiting.length && newest === null)) return;
    timer = setTimeout(speak, Math.max(due - performance.now(), TOGETHER_MS));
  }

  function speak() {
    timer = 0;
    if (!waiting.length && newest === null) return;
    let sentence = newest;
    if (waiting.length) {
      sentence = waiting.join(" ");
      waiting = [];
    } else {
      shape = readShape(newest);
      newest = null;
    }
    due = performance.now() + gap_ms;
    // The same words again are a change only if something differs.
    region.textContent = region.textContent === sentence ? `${sentence}\u00a0` : sentence;
    clearTimeout(ends);
    ends = setTimeout(() => { region.textContent = ""; }, KEPT_MS);
    plan();
  }

  return {
    say(sentence) {
      if (level !== LEVELS.all) return;
      if (readShape(sentence) === shape) newest = null; // back to the last sentence
      else newest = sentence;
      plan();
    },
    tell(sentence) {
      if (level === LEVELS.none || !sentence || waiting.includes(sentence)) return;
      waiting.push(sentence);
      plan();
    },
    get level() {
      return level;
    },
    set level(chosen) {
      level = chosen;
      remember(KEY, chosen);
      clearTimeout(timer);
      timer = 0;
      waiting = [];
      newest = null;
      shape = "";
      region.textContent = "";
    },
  };
}

function readShape(sentence) {
  return sentence.replace(/[\d.]+/g, "");
}
