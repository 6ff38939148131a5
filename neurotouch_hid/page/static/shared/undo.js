// A button that undoes. While there is nothing to undo it does nothing, and says so beside it.

import { watchPresses } from "./presses.js";
import { element } from "./wire.js";

const TWICE = "Pressed twice at once: only one change is undone.";

// `words` say that there is nothing to undo; `tell` speaks them. Returns a function that takes
// whether there is something. The button keeps its place in the order of the Tab key, so that the
// last undo leaves the focus where it is.
export function makeUndo(button, words, undo, tell) {
  const reason = element("span", { id: `${button.id}-reason`, class: "aside" });
  let can = false;
  button.setAttribute("aria-describedby", reason.id);
  button.classList.add("undo");
  button.after(reason);
  const isTwice = watchPresses();
  button.addEventListener("click", () => {
    const wasTwice = isTwice();
    if (!can) tell(words);
    else if (wasTwice) tell(TWICE);
    else undo();
  });
  function show(now) {
    can = now;
    button.setAttribute("aria-disabled", String(!can));
    reason.textContent = can || button.disabled ? "" : words; // a page for looking has its own
  }
  show(false);
  return show;
}
