// A gel for mouse, touch and keys: sends commands to the simulated hand, and draws the markers.

import { drawDisc, findScale } from "../shared/disc.js";
import { colour, element } from "../shared/wire.js";
import { Hand } from "./hand.js";

export const MOUSE = "sim:mouse"; // the source that such a gel presses
const AGAIN_MS = 100; // a held command repeats, so that the simulator knows that a person is there
const LEAST_MS = 6; // mice may report a thousand times a second; the gel has 250 moments
const FINGER_MM = 6.5;
const GESTURES = {
  push_left: "← Push left", push_right: "→ Push right", push_up: "↑ Push up",
  push_down: "↓ Push down", pinch: "Pinch (−)", zoom: "Zoom (+)",
  twist_ccw: "↺ Twist (Q)", twist_cw: "↻ Twist (E)",
};

// `send(command)` sends a command to the simulated hand. Call `turn(now, state)` in each animation
// frame.
export function makeGel(canvas, send) {
  const hand = new Hand(canvas, (event) => {
    const { left, top, width, height } = canvas.getBoundingClientRect();
    const scale = findScale(width, height);
    return [(event.clientX - left - width / 2) / scale, (event.clientY - top - height / 2) / scale];
  });
  const settings = { tremor_mm: 0, weak_zoom: 0, resting: false };
  let sent = "";
  let sentAt = 0;
  let before = performance.now();
  let drawn = null; // draws each state once, because the browser needs its time for the mouse

  function sendCommand(at_ms) {
    const command = { ...hand.command, ...settings };
    const key = JSON.stringify(command);
    const now = performance.now();
    const due = key !== sent ? now - sentAt >= LEAST_MS
      : (command.down || command.resting) && now - sentAt >= AGAIN_MS;
    if (!due) return;
    sent = key;
    sentAt = now;
    send({ do: "hand", at_ms, ...command });
  }
  hand.changed = sendCommand;

  function turn(now, state) {
    hand.advance(Math.min((now - before) / 1000, 0.1), now);
    before = now;
    sendCommand(performance.timeOrigin + performance.now());
    if (!state || state === drawn) return;
    drawn = state;
    drawDisc(canvas, state);
    drawFinger(canvas, hand.command);
  }

  drawDisc(canvas, null);
  addEventListener("resize", () => { drawn = null; });
  return { hand, settings, turn };
}

// A button for each gesture. It acts as long as it is pressed, but never too briefly to be noticed:
// a click without a hold, as screen readers and switches send it, is a short press.
export function makeGestureButtons(box, hand) {
  for (const [gesture, name] of Object.entries(GESTURES)) {
    const button = element("button", { type: "button", text: name, "data-gesture": gesture });
    const press = () => hand.press(gesture);
    const release = () => hand.release(gesture);
    button.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      button.focus();
      button.setPointerCapture(event.pointerId);
      press();
    });
    for (const end of ["pointerup", "pointercancel", "blur", "keyup"]) {
      button.addEventListener(end, release);
    }
    button.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      press();
    });
    button.addEventListener("click", (event) => {
      if (event.detail) return; // a mouse, which sends press and release events
      press();
      release();
    });
    box.append(button);
  }
}

function drawFinger(canvas, { down, x_mm, y_mm, push_x_mm, push_y_mm }) {
  if (!down) return;
  const context = canvas.getContext("2d");
  context.strokeStyle = colour("warm");
  context.lineWidth = 0.5;
  context.beginPath();
  context.arc(x_mm + push_x_mm, y_mm + push_y_mm, FINGER_MM, 0, 2 * Math.PI);
  context.stroke();
}
