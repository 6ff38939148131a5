// Chooses a movement's output: from a picture of the gamepad, from a list, or by pressing the key or
// the button.

import { element, showOptions } from "../shared/wire.js";
import { makePad } from "../shared/pad.js";
import { hasGamepads, makePadListener } from "./gamepads.js";
import { nameKey } from "./keys.js";
import { MOVEMENTS, belongs } from "./movements.js";
import { nameOutput } from "./outputs.js";

const NOT_ALONE = ["stick left", "stick right", "mouse pointer"]; // need all directions of a push
const SIDES = { push_left: "_x -", push_right: "_x +", push_up: "_y -", push_down: "_y +" };
const TOLD_MS = 200;
const MODIFIERS = [["Control", "ctrl"], ["Shift", "shift"], ["Alt", "alt"], ["AltGraph", "altgr"],
  ["Meta", "super"]];

// `bind(movement, press, mode, output, instead)` is called with the words of the choice. A gamepad is
// heard while `isQuiet()` is true: then the gel moves no gamepad.
export function makeChooser(dialog, { bind, closed, isQuiet }) {
  const find = (id) => dialog.querySelector(`#${id}`);
  let groups = [];
  let movement = "";
  let own = []; // the bindings that it may replace

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
  }

  find("group-choice").addEventListener("change", () => showGroup(find("group-choice").value));

  let catches = false;
  find("key-catch").addEventListener("click", () => {
    listen(true);
  });
  function listen(wanted) {
    catches = wanted;
    dialog.toggleAttribute("data-takes-keys", wanted); // the header's key is a key like others
    find("key-catch").textContent = wanted ? "Waiting for the key …" : "Press a key now";
    find("key-said").textContent = "";
  }
  dialog.addEventListener("keydown", (event) => {
    if (!catches || MODIFIERS.some(([name]) => event.key === name)) return;
    event.preventDefault();
    event.stopPropagation();
    const key = nameKey(event.code);
    listen(false);
    if (!key) {
      find("key-said").textContent = "This key has no name in profiles. Take another one.";
      return;
    }
    const held = MODIFIERS.filter(([name]) => event.getModifierState(name)).map(([, name]) => name);
    take(`key ${[...held, key].join("+")}`);
  });
  const pads = makePadListener({ mayHear: isQuiet, heard: takePressed });
  function takePressed(output) {
    if (!output) {
      find("key-said").textContent = "This gamepad does not say which button that is. Choose it here.";
      return;
    }
    const [kind, axis] = output.split(" ");
    // A push in all directions moves the stick in all directions.
    const isWhole = movement === "push" && kind === "axis";
    take(isWhole ? `stick ${axis.split("_")[0]}` : output);
  }

  dialog.addEventListener("close", () => {
    pads.stop();
    listen(false);
    closed();
  });

  function listOwn(layer) {
    own = (layer ? layer.bindings : [])
      .filter((each) => each.key !== null && belongs(each, movement));
    showOptions(find("instead-choice"), [
      ...own.map((each) => [each.key, `${each.when}, ${nameOutput(groups, each.do)}`]),
      ["", "nothing: keep both"],
    ]);
  }

  return {
    get isOpen() { return dialog.open; },
    close: () => dialog.close(),
    // The profile has been changed elsewhere. Returns false if the binding to replace is gone; the
    // key of another one may be its former key.
    refresh(layer) {
      const { value } = find("instead-choice");
      const before = own.find(({ key }) => key === value);
      listOwn(layer);
      const same = before && own.filter((each) => each.do === before.do).find((each) =>
        each.key === value || each.when === before.when);
      find("instead-choice").value = same ? same.key : "";
      return Boolean(same) || !before;
    },
    setOutputs(given) {
      const chosen = find("group-choice").value;
      groups = given;
      showOptions(find("group-choice"), groups.map(({ name }) => [name, name]));
      if (dialog.open && groups.length) showGroup(chosen || groups[0].name); // it came late
    },
    name: (output) => nameOutput(groups, output),
    // `instead` is the key of the binding it replaces; without it, the first one of the movement.
    open(which, layer, instead) {
      movement = which;
      find("chooser-title").textContent = `${MOVEMENTS[which][1]} does …`;
      find("press-choice").value = "";
      listOwn(layer);
      if (instead !== undefined) find("instead-choice").value = instead;
      showGroup(groups.length ? groups[0].name : "");
      find("chooser-told").textContent = "";
      const press = isQuiet() && hasGamepads() ? "Press a button of a gamepad, or choose here." : "";
      find("press-now").textContent = press;
      dialog.showModal();
      pads.start();
      // Announced after the dialog is open: a screen reader that comes from the gel reads no title.
      setTimeout(() => {
        find("chooser-told").textContent = `${MOVEMENTS[which][1]}: choose what it does. ${press}`;
      }, TOLD_MS);
    },
  };
}
