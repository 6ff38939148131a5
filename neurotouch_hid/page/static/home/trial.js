// After a binding is saved: asks for its movement once more, and says when its output has come.

import { MOVEMENTS } from "./movements.js";

const RECENT_MS = 2000; // a tap acts after its movement has ended
const LEAST = 0.05; // of an axis
const TOLD = ["button", "key", "trigger", "stick", "axis", "dpad", "mouse"]; // by a state

// Returns true if a gamepad's state has this output.
function hasOutput(pad, output) {
  const [kind, name, sign] = output.split(" ");
  const value = (axis) => pad.axes[axis] || 0;
  if (kind === "button") return pad.buttons.includes(name);
  if (kind === "key") return pad.keys.length > 0;
  if (kind === "trigger") return value(`${name}_trigger`) > LEAST;
  if (kind === "stick") return Math.hypot(value(`${name}_x`), value(`${name}_y`)) > LEAST;
  if (kind === "axis") return (sign === "-" ? -1 : 1) * value(name) > LEAST;
  if (kind === "dpad") {
    const axis = name === "left" || name === "right" ? "dpad_x" : "dpad_y";
    return (name === "left" || name === "up" ? -1 : 1) * value(axis) > LEAST;
  }
  if (kind === "mouse" && name === "pointer") return pad.pointer.some(Boolean);
  if (kind === "mouse" && name === "wheel") return Boolean(pad.wheel);
  return kind === "mouse" && pad.mouse.length > 0;
}

// `name(output)` returns the output's name on the page.
export function makeTrial(find, say, name) {
  let asked = null; // a binding that is being saved
  let wanted = null; // one whose movement is awaited
  let made = -Infinity;

  function clear() {
    [asked, wanted] = [null, null];
    say("trial", "");
    find("fly-now").hidden = true;
  }

  return {
    clear,
    // `n` is the number of the request that saves it.
    ask(n, movement, output) {
      clear();
      if (TOLD.includes(output.split(" ")[0])) asked = { n, movement, output };
    },
    saved(n) {
      if (!asked || asked.n !== n) return;
      [wanted, asked, made] = [asked, null, -Infinity];
      say("trial", `Now try it: ${MOVEMENTS[wanted.movement][1].toLowerCase()}.`);
    },
    hear({ state, gesture, pad }, now) {
      if (!wanted || state !== "running") return;
      const { movement, output } = wanted;
      const isMade = movement === "push" ? gesture.movement.startsWith("push_")
        : gesture.movement === movement;
      if (isMade) made = now;
      if (now - made > RECENT_MS || !hasOutput(pad, output)) return;
      wanted = null;
      say("trial", `It works. ${MOVEMENTS[movement][1]}: ${name(output)}.`);
      find("fly-now").hidden = false;
    },
  };
}
