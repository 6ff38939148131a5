// Shows the questions of `neurotouch calibrate`, with buttons for its keys.

import { element } from "../shared/wire.js";

const STEP = /^Step (\d+) of (\d+)\. (.*)$/;
const CHOICE = /^ {2}(\d+)\. (.*)$/;
const ASKS = /^Number, 1 to \d+:$/;
const KEYS = /^Enter = next/;

export function makeCalibration(find, answer) {
  let choices = [];
  let question = "";
  let runs = false;

  for (const button of find("answers").querySelectorAll("button")) {
    button.addEventListener("click", () => answer(button.dataset.answer));
  }

  function begin() {
    choices = [];
    runs = true;
    find("measuring").hidden = false;
    find("request").textContent = "One moment …";
    find("answer").textContent = "";
    find("measured").replaceChildren();
    showChoices(false);
    find("answers").hidden = false;
    find("measure").hidden = true;
  }

  function showChoices(asks) {
    find("choices").hidden = !asks;
    find("answers").hidden = asks;
    if (!asks) return;
    find("request").textContent = question;
    find("choices").replaceChildren(...choices.map(([number, text]) => {
      const button = element("button", { type: "button", text });
      button.addEventListener("click", () => {
        answer(number);
        showChoices(false);
        find("answers").hidden = true; // the last question is over
      });
      return button;
    }));
    find("choices").querySelector("button").focus();
  }

  function hear(news) {
    if (!runs) begin(); // another page started it
    if ("code" in news) {
      runs = false;
      find("request").textContent = news.code === 0 ? "Done." : "Ended. Nothing was saved.";
      find("answers").hidden = find("choices").hidden = true;
      find("measure").hidden = false;
      find("measure").textContent = "Measure my range again";
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
      find("answer").textContent = line;
      find("measured").append(element("li", { text: line }));
    }
  }

  return { begin, hear, get runs() { return runs; } };
}
