// Cards of all movements and their outputs; the present movement is marked.

import { element } from "../shared/wire.js";

export const MOVEMENTS = {
  push: ["✛", "Push, any direction"],
  push_left: ["←", "Push left"], push_right: ["→", "Push right"],
  push_up: ["↑", "Push up"], push_down: ["↓", "Push down"],
  pinch: ["→←", "Pinch"], zoom: ["←→", "Zoom"],
  twist_cw: ["↻", "Twist clockwise"], twist_ccw: ["↺", "Twist counter-clockwise"],
};
const LEAST_MM = 1.5; // smallest movement that chooses a card
const DIRECTIONS = 4;

// Returns true if the binding is for this movement alone; a push in any direction counts as one.
export function belongs(binding, movement) {
  const isAnyPush = binding.movements.length === DIRECTIONS;
  return movement === "push" ? isAnyPush : !isAnyPush && binding.movements.includes(movement);
}

// Returns true if the card of this movement names a movement that stops everything.
export function stops({ movements }, movement) {
  const isAnyPush = movements.filter((each) => each.startsWith("push_")).length === DIRECTIONS;
  return movement === "push" ? isAnyPush : movements.includes(movement);
}

export function makeCards(list, { choose, remove, name: nameOutput }) {
  const cards = {};
  for (const [movement, [sign, name]] of Object.entries(MOVEMENTS)) {
    const does = element("ul");
    const add = element("button", { type: "button", text: "Add", "aria-label": `${name}: add`,
      "data-place": `${movement} add` });
    add.addEventListener("click", () => choose(movement, ""));
    cards[movement] = { does, card: element("li", { class: "movement", "data-movement": movement },
      element("h3", {}, element("span", { class: "sign", "aria-hidden": "true", text: sign }), name),
      does, element("div", { class: "row" }, add)), add };
    list.append(cards[movement].card);
  }

  // `view` is the profile that has the layer.
  function show(layer, view, edit) {
    for (const [movement, { does, add }] of Object.entries(cards)) {
      add.hidden = !edit;
      const bindings = layer ? layer.bindings : [];
      const rows = bindings.filter((each) => belongs(each, movement)).map((binding) => {
        const row = element("li", {}, element("span", { text: describe(binding, nameOutput) }));
        if (edit && binding.key !== null) row.append(...makeButtons(movement, binding));
        return row;
      });
      const shared = movement.startsWith("push_")
        ? bindings.filter((each) => belongs(each, "push")) : [];
      rows.push(...shared.map((binding) => element("li", { class: "shared",
        text: `with every push: ${nameOutput(binding.do)}` })));
      if (!rows.length) rows.push(element("li", { class: "shared", text: "nothing" }));
      rows.push(...(layer ? view.stops : []).filter((each) => stops(each, movement))
        .map(({ when, does: what }) => element("li", { class: "stop", text: `${when}: ${what}` })));
      does.replaceChildren(...rows);
    }
  }

  function makeButtons(movement, binding) {
    const what = `${binding.when}, ${nameOutput(binding.do)}`;
    const change = element("button", { type: "button", text: "Change",
      "aria-label": `Change ${what}`, "data-place": `${movement} ${binding.key}` });
    const away = element("button", { type: "button", text: "Remove",
      "aria-label": `Remove ${what}`, "data-place": `${movement} ${binding.key} remove ${what}` });
    change.addEventListener("click", () => choose(movement, binding.key));
    away.addEventListener("click", () => remove(binding));
    return [change, away];
  }

  let made = "";
  function mark(movement) {
    if (movement === made) return;
    if (made in cards) cards[made].card.classList.remove("made");
    if (movement in cards) cards[movement].card.classList.add("made");
    made = movement;
  }

  return { show, mark };
}

// Describes a binding without its movement, which the card names.
const MOVEMENT = /^(push( (left|right|up|down))?|pinch|zoom|twist( (counter-)?clockwise)?)/;
export function describe(binding, nameOutput) {
  const when = binding.when.replace(MOVEMENT, "");
  return `${when.trim() ? `${when.trim()}: ` : ""}${nameOutput(binding.do)}`;
}

// Waits for one whole movement, from rest to rest, and returns the largest one.
export function makeListener(heard) {
  let waits = false;
  let best = {};
  return {
    start() { [waits, best] = [true, {}]; },
    stop() { waits = false; },
    get waits() { return waits; },
    hear({ kind, movement, felt_mm }) {
      if (!waits) return;
      if (kind !== "none") {
        if (movement !== "none") best[movement] = Math.max(best[movement] || 0, felt_mm);
        return;
      }
      const [furthest] = Object.entries(best).sort((a, b) => b[1] - a[1]);
      best = {};
      if (!furthest || furthest[1] < LEAST_MM) return;
      waits = false;
      heard(furthest[0]);
    },
  };
}
