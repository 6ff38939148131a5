// Chooses a movement's output: from a picture of the gamepad, from a list, or by pressing the key.

import { element } from "../shared/wire.js";
import { makePad } from "../shared/pad.js";
import { MOVEMENTS, belongs } from "./movements.js";
import { nameOutput } from "./outputs.js";

const NOT_ALONE = ["stick left", "stick right", "mouse pointer"]; // need all directions of a push
const SIDES = { push_left: "_x -", push_right: "_x +", push_up: "_y -", push_down: "_y +" };
const TOLD_MS = 200;
const KEYS = {
  " ": "space", Control: "ctrl", Shift: "shift", Alt: "alt", Meta: "super", Enter: "enter",
  Escape: "escape", Tab: "tab", Backspace: "backspace", Delete: "delete", Insert: "insert",
  Home: "home", End: "end", PageUp: "page_up", PageDown: "page_down", ArrowUp: "up",
  ArrowDown: "down", ArrowLeft: "left", ArrowRight: "right", "-": "minus", "=": "equal",
  ",": "comma", ".": "dot", "/": "slash", ";": "semicolon",
};

// `bind(movement, press, mode, output, instead)` is called with the words of the choice.
export function makeChooser(dialog, { bind, closed }) {
  const find = (id) => dialog.querySelector(`#${id}`);
  let groups = [];
  let movement = "";

  makePad(find("pad-picture"), { textContent: "" }, (part) => {
    const found = findPart(part);
    if (found) take(found);
    else find("outputs").querySelector("button")?.focus();
  });

  function findPart(part) {
    if (part === "left" || part === "right") {
      if (movement === "push") return `stick ${part}`;
      if (movement in SIDES) return `axis ${part}${SIDES[movement]}`;
      showGroup("Sticks");
      return null;
    }
    if (part.endsWith("_trigger")) return `trigger ${part.split("_")[0]}`;
    if (part.startsWith("dpad_")) return `dpad ${part.split("_")[1]}`;
    return `button ${part}`;
  }

  function take(output) {
    const press = find("press-choice").value;
    bind({ movement, do_this: output, instead: find("instead-choice").value,
      press: press === "toggle" ? "" : press, mode: press === "toggle" ? "toggle" : "" });
    dialog.close();
  }

  function showGroup(name) {
    find("group-choice").value = name;
    const group = groups.find((each) => each.name === name);
    const outputs = (group ? group.outputs : [])
      .filter((each) => movement === "push" || !NOT_ALONE.includes(each.do));
    find("outputs").replaceChildren(...outputs.map((output) => {
      const button = element("button", { type: "button", text: output.label });
      button.addEventListener("click", () => take(output.do));
      return button;
    }));
    find("key-catch").hidden = name !== "Keyboard";
  }

  find("group-choice").addEventListener("change", () => showGroup(find("group-choice").value));

  let catches = false;
  find("key-catch").addEventListener("click", () => {
    catches = true;
    find("key-catch").textContent = "Waiting for the key …";
  });
  dialog.addEventListener("keydown", (event) => {
    if (!catches || ["Control", "Shift", "Alt", "Meta"].includes(event.key)) return;
    event.preventDefault();
    event.stopPropagation();
    catches = false;
    const modifiers = [["ctrlKey", "ctrl"], ["shiftKey", "shift"], ["altKey", "alt"],
      ["metaKey", "super"]].filter(([flag]) => event[flag]).map(([, name]) => name);
    const key = KEYS[event.key] || event.key.toLowerCase();
    take(`key ${[...modifiers, key].join("+")}`);
  });
  dialog.addEventListener("close", () => {
    catches = false;
    find("key-catch").textContent = "Press the key now";
    closed();
  });

  return {
    setOutputs(given) {
      groups = given;
      find("group-choice").replaceChildren(...groups.map(({ name }) =>
        element("option", { value: name, text: name })));
    },
    name: (output) => nameOutput(groups, output),
    // `instead` is the key of the binding it replaces; without it, the first one of the movement.
    open(which, layer, instead) {
      movement = which;
      find("chooser-title").textContent = `${MOVEMENTS[which][1]} does …`;
      find("press-choice").value = "";
      const own = (layer ? layer.bindings : [])
        .filter((each) => each.key !== null && belongs(each, which));
      find("instead-choice").replaceChildren(
        ...own.map((each) => element("option", { value: each.key,
          text: `${each.when}, ${nameOutput(groups, each.do)}` })),
        element("option", { value: "", text: "nothing: keep both" }));
      if (instead !== undefined) find("instead-choice").value = instead;
      showGroup(groups.length ? groups[0].name : "");
      find("chooser-told").textContent = "";
      dialog.showModal();
      // Announced after the dialog is open: a screen reader that comes from the gel reads no title.
      setTimeout(() => {
        find("chooser-told").textContent = `${MOVEMENTS[which][1]}: choose what it does.`;
      }, TOLD_MS);
    },
  };
}
