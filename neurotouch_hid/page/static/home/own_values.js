// How the program helps this person: each value with what it means. A choice is saved at once.

import { element } from "../shared/wire.js";

const BY_PROFILE = ["", "as the profile says", "Each profile brings its own."];
const VALUES = [
  ["filter", "Tremor filter", [
    BY_PROFILE,
    ["none", "none", "Nothing is smoothed, and nothing comes later."],
    ["light", "light", "A light tremor is smoothed. The delay can hardly be felt."],
    ["medium", "medium", "More is smoothed. Everything comes a little later."],
    ["strong", "strong", "Most is smoothed. The delay can be felt."],
  ]],
  ["timing", "Timing", [
    BY_PROFILE,
    ["game", "usual", "A movement counts as soon as it is large enough."],
    ["steady", "steady", "A movement must last a moment, so that fewer presses happen by accident."],
    ["slow", "slow", "There is most time. A long movement must be kept longer, too."],
  ]],
  ["neutral", "Hand between movements", [
    ["lifted", "leaves the gel", "An untouched gel counts as nothing."],
    ["resting", "stays on the gel", "Once your hand has been still for a moment, its pose counts as nothing."],
  ]],
  ["fatigue", "When you tire", [
    ["suggest", "tell me", "The status says when a movement has become smaller."],
    ["auto", "help by itself", "Smaller and smaller movements are enough, until you have rested."],
    ["none", "do nothing", "Your movements are not compared with earlier ones."],
  ]],
  ["feedback.sound", "What you hear", [
    ["none", "nothing", "It is silent."],
    ["tones", "tones", "A short tone tells each press, and what was ignored."],
    ["speech", "speech", "A voice says what happens."],
  ]],
];
const OWN = ["own", "your own times", "You have set times of your own in your file."];

// `choose(name, value)` is called with what a person has chosen.
export function makeOwnValues(list, choose) {
  const shown = {};
  for (const [name, label, options] of VALUES) {
    const id = `own-${name.replace(".", "-")}`;
    const select = element("select", { id, "aria-describedby": `${id}-about`, "data-value": name },
      ...options.map(([value, text]) => element("option", { value, text })));
    const about = element("p", { id: `${id}-about`, class: "aside" });
    select.addEventListener("change", () => {
      tell(name);
      choose(name, select.value);
    });
    list.append(element("div", { class: "value" },
      element("label", { for: id, text: label }), select, about));
    shown[name] = { select, about, options };
  }

  function tell(name) {
    const { select, about, options } = shown[name];
    const words = [...options, OWN].find(([value]) => value === select.value)[2];
    if (about.textContent !== words) about.textContent = words;
  }

  // `values` are missing where they cannot be read.
  return function show(values, edit) {
    for (const [name, { select }] of Object.entries(shown)) {
      select.disabled = !edit || !values;
      if (!values) continue;
      const own = select.querySelector("option[value=own]");
      if (values[name] !== "own" && own) own.remove();
      else if (values[name] === "own" && !own) {
        select.prepend(element("option", { value: OWN[0], text: OWN[1] }));
      }
      if (select.value !== values[name]) select.value = values[name];
      tell(name);
    }
  };
}
