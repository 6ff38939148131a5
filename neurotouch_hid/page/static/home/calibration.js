// Shows the questions of `neurotouch calibrate`, with buttons for its keys.

import { element } from "../shared/wire.js";

const STEP = /^Step (\d+) of (\d+)\. (.*)$/;
const CHOICE = /^ {2}(\d+)\. (.*)$/;
const ASKS = /^Number, 1 to \d+:$/;
const KEYS = /^Enter = next/;
const KEPT = /^What you did is kept/;
const OUTCOME = /^(?:OK|WARNING)\s+(.*)$/;
const SAVED = /^Saved /;

export function makeCalibration(find, answer) {
  let choices = [];
  let question = "";
  let runs = false;
  let kept = false;
  let outcome = ""; // whether something was saved, and why not
  let unfinished = ""; // how far a measurement is that was not finished

  for (const button of find("answers").querySelectorAll("button")) {
    button.addEventListener("click", () => answer(button.dataset.answer));
  }

  function begin() {
    choices = [];
    [runs, kept, outcome] = [true, false, ""];
    find("measuring").hidden = false;
    find("request").textContent = "One moment …";
    find("answer").textContent = "";
    find("measured").replaceChildren();
    showChoices(false);
    find("answers").hidden = false;
    find("measure").hidden = true;
  }

  // Whatever ended it, the next one continues where this one was.
  function end() {
    runs = false;
    find("answers").hidden = find("choices").hidden = true;
    find("measure").hidden = false;
    nameButton();
  }

  function lose() {
    if (!runs) return;
    end();
    find("request").textContent = "The connection is lost. What you did is kept.";
    find("answer").textContent = "";
  }

  // The connection is new: a calibration that still runs is told right after this.
  function reset() {
    find("measuring").hidden = true;
    end();
  }

  function nameButton() {
    const again = find("measured").childElementCount ? "Measure my range again" : "Measure my range";
    find("measure").textContent = unfinished ? "Continue measuring" : again;
  }

  function setUnfinished(words) {
    if (words === unfinished) return;
    unfinished = words;
    nameButton();
  }

  function showChoices(asks) {
    find("choices").hidden = !asks;
    find("answers").hidden = asks;
    if (!asks) return;
    find("request").textContent = question;
    find("answer").textContent = ""; // it was the same sentence
    find("choices").replaceChildren(...choices.map(([number, text]) => {
      const button = element("button", { type: "button", text });
      button.addEventListener("click", () => {
        answer(number);
        showChoices(false);
        find("answers").hidden = true; // the last question is over
        find("request").textContent = "One moment …";
      });
      return button;
    }));
    find("choices").querySelector("button").focus();
  }

  function hear(news) {
    if (!runs) begin(); // another page started it
    if ("code" in news) {
      end();
      find("request").textContent = news.code === 0 && outcome ? outcome : "Ended. Nothing was saved.";
      if (kept) find("request").textContent = "Ended. What you did is kept.";
      find("measure").focus();
      return;
    }
    const { line } = news;
    if (!line || KEYS.test(line)) return;
    const step = STEP.exec(line);
    const choice = CHOICE.exec(line);
    if (step) {
      find("request").textContent = `${step[1]} of ${step[2]}: ${step[3]}`;
      find("answer").textContent = "";
    } else if (choice) {
      choices.push([choice[1], choice[2]]);
    } else if (ASKS.test(line)) {
      showChoices(true);
      choices = [];
    } else {
      choices = [];
      question = line;
      noteOutcome(line);
      find("answer").textContent = line;
      find("measured").append(element("li", { text: line }));
      kept ||= KEPT.test(line);
    }
  }

  // The line after "Saved" says whether it applies. Its file is for the terminal.
  function noteOutcome(line) {
    const [, words] = OUTCOME.exec(line) || [];
    if (words) outcome = SAVED.test(words) ? "Saved." : words;
    else if (outcome === "Saved.") outcome = `Saved. ${line}`;
  }

  return { begin, hear, lose, reset, setUnfinished, get runs() { return runs; } };
}
