// Hears which button or stick of a real gamepad a person presses, in the words of outputs.

const BUTTONS = ["button a", "button b", "button x", "button y", "button lb", "button rb",
  "trigger left", "trigger right", "button back", "button start", "button ls", "button rs",
  "dpad up", "dpad down", "dpad left", "dpad right", "button guide"];
const AXES = ["axis left_x", "axis left_y", "axis right_x", "axis right_y"];
const FAR = 0.7; // of a stick's way

// Browsers give gamepads to encrypted pages and to those of this machine, not to a phone's.
export const hasGamepads = () => Boolean(navigator.getGamepads) && isSecureContext;

function listPads() {
  return [...navigator.getGamepads()].filter(Boolean);
}

function readPressed({ buttons, axes }) {
  const pressed = buttons.map((each, i) => (each.pressed ? BUTTONS[i] || "?" : ""));
  const pushed = axes.map((value, i) => (Math.abs(value) > FAR
    ? `${AXES[i] || "?"} ${value < 0 ? "-" : "+"}` : ""));
  return new Set([...pressed, ...pushed].filter(Boolean));
}

// While it listens, `heard(output)` is called for each new press; with "" if the gamepad does not
// say which of its buttons is which. What is pressed while `mayHear()` is false does not count: our
// own gamepad is one of these, unless the driver is paused.
export function makePadListener({ mayHear, heard }) {
  let before = new Map(); // what was pressed, by the number of the gamepad
  let request = 0;

  function look() {
    request = requestAnimationFrame(look);
    const now = new Map(listPads().map((pad) => [pad.index, pad]));
    const fresh = [...now.values()].flatMap((pad) => {
      // A gamepad appears with its first press, which counts.
      const old = before.get(pad.index) || new Set();
      const all = [...readPressed(pad)].filter((each) => !old.has(each));
      return all.map((each) => (pad.mapping === "standard" ? each : ""));
    });
    before = new Map([...now].map(([index, pad]) => [index, readPressed(pad)]));
    if (fresh.length && mayHear()) heard(fresh[0]);
  }

  return {
    start() {
      if (!hasGamepads() || request) return;
      before = new Map(listPads().map((pad) => [pad.index, readPressed(pad)]));
      request = requestAnimationFrame(look);
    },
    stop() {
      cancelAnimationFrame(request);
      request = 0;
    },
  };
}
