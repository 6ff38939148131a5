// Combines mouse, touch, wheel, keys and buttons into one command for the simulated hand.

import { readKey } from "../shared/presses.js";

const REACH_MM = 22;
const SPREAD_MM = 10;
const TWIST_RAD = 1;
const PUSH_MM = 18;
const FINGER_MM = 13; // a twist of this many mm at the fingers is one radian
const KEY_S = 0.25; // from nothing to the full strength of a key
const LEAST_PRESS_MS = 600; // a tap, and a click without a hold, make a whole movement too
const WHEEL_MM = 0.012; // per unit of a wheel's turn
const WHEEL_MS = 450; // after its last turn the fingers release

const KEYS = {
  ArrowLeft: "push_left", ArrowRight: "push_right", ArrowUp: "push_up", ArrowDown: "push_down",
  q: "twist_ccw", e: "twist_cw", "+": "zoom", "=": "zoom", "-": "pinch", "−": "pinch",
};

const clamp = (value, most) => Math.min(Math.max(value, -most), most);

export class Hand {
  // `place(event)` returns a pointer's place on the gel in mm.
  constructor(canvas, place) {
    this.size_mm = 6;
    this.held = false; // by the button or by Ctrl
    this._ctrl = false;
    this._pointers = new Map();
    this._acting = new Map(); // gestures of keys and buttons: 0..1
    this._pressed = new Set();
    this._lasts = new Map(); // until when a press acts at least
    this._laid = null;
    this._wheel_mm = 0;
    this._wheel_at = [0, 0];
    this._wheel_until = 0;
    this._drag = { x: 0, y: 0, push: [0, 0], spread: 0, twist: 0, down: false };
    this.changed = () => {};
    this._listen(canvas, place);
  }

  get isHeld() {
    return this.held || this._ctrl;
  }

  press(gesture) {
    if (this._pressed.has(gesture)) return; // a held key repeats
    this._lasts.clear(); // another one ends a tap that still acts
    this._pressed.add(gesture);
    this._lasts.set(gesture, performance.now() + LEAST_PRESS_MS);
    if (!this._acting.has(gesture)) this._acting.set(gesture, 0);
  }

  release(gesture) {
    this._pressed.delete(gesture);
  }

  // Advances time by dt seconds; returns true while anything still moves.
  advance(dt, now) {
    let moves = false;
    for (const [gesture, share] of this._acting) {
      if (this._pressed.has(gesture) || now < this._lasts.get(gesture)) {
        this._acting.set(gesture, Math.min(share + dt / KEY_S, 1));
      } else if (!this.isHeld) {
        this._acting.delete(gesture);
      }
      moves = true;
    }
    if (this._wheel_mm && now > this._wheel_until && !this.isHeld) {
      this._wheel_mm = 0;
      moves = true;
    }
    if (this._drag.down && !this._pointers.size && !this.isHeld) {
      this._drag.down = false;
      moves = true;
    }
    return moves;
  }

  get command() {
    const drag = this._drag.down ? this._drag : { x: 0, y: 0, push: [0, 0], spread: 0, twist: 0 };
    const size = this.size_mm;
    const of = (gesture) => ease(this._acting.get(gesture) || 0);
    const [x, y] = this._drag.down ? [drag.x, drag.y] : this._wheel_mm ? this._wheel_at : [0, 0];
    const twist = drag.twist + (size / FINGER_MM) * (of("twist_cw") - of("twist_ccw"));
    return {
      down: this._drag.down || this._acting.size > 0 || this._wheel_mm !== 0,
      x_mm: x,
      y_mm: y,
      push_x_mm: clamp(drag.push[0] + size * (of("push_right") - of("push_left")), PUSH_MM),
      push_y_mm: clamp(drag.push[1] + size * (of("push_down") - of("push_up")), PUSH_MM),
      spread_mm: clamp(drag.spread + this._wheel_mm + size * (of("zoom") - of("pinch")), SPREAD_MM),
      twist_rad: clamp(twist, TWIST_RAD),
    };
  }

  _listen(canvas, place) {
    const stamp = (event) => this.changed(performance.timeOrigin + event.timeStamp);
    canvas.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      canvas.focus({ preventScroll: true });
      canvas.setPointerCapture(event.pointerId);
      const at = place(event);
      this._pointers.set(event.pointerId, { from: at, at });
      this._lay();
      stamp(event);
    });
    const move = (event) => {
      const pointer = this._pointers.get(event.pointerId);
      if (!pointer) return;
      pointer.at = place(event);
      this._follow();
      stamp(event);
    };
    // Raw moves arrive as the mouse reports them, others wait for the next picture.
    canvas.addEventListener("onpointerrawupdate" in window ? "pointerrawupdate" : "pointermove",
      move);
    const up = (event) => {
      if (!this._pointers.delete(event.pointerId)) return;
      if (this._pointers.size) this._lay();
      else if (!this.isHeld) this._drag.down = false;
      stamp(event);
    };
    canvas.addEventListener("pointerup", up);
    canvas.addEventListener("pointercancel", up);
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      if (!this._wheel_mm) this._wheel_at = place(event).map((mm) => clamp(mm, 8));
      this._wheel_mm = clamp(this._wheel_mm - WHEEL_MM * event.deltaY, SPREAD_MM) || 0.01;
      this._wheel_until = performance.now() + WHEEL_MS;
      stamp(event);
    }, { passive: false });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("keydown", (event) => {
      const gesture = KEYS[readKey(event)];
      if (!gesture || event.altKey || event.metaKey) return;
      event.preventDefault();
      this.press(gesture);
    });
    addEventListener("keydown", (event) => { if (event.key === "Control") this._ctrl = true; });
    addEventListener("keyup", (event) => {
      if (event.key === "Control") this._ctrl = false;
      const gesture = KEYS[readKey(event)];
      if (gesture) this.release(gesture);
    });
    addEventListener("blur", () => {
      this._ctrl = false;
      this._pressed.clear();
    });
  }

  // A finger was laid down or lifted: the movement counts from here.
  _lay() {
    const all = [...this._pointers.values()];
    for (const pointer of all) pointer.from = pointer.at;
    const [x, y] = middle(all.map((each) => each.at));
    this._laid = spanOf(all.map((each) => each.at));
    this._drag = { x: clamp(x, REACH_MM), y: clamp(y, REACH_MM), push: [0, 0], spread: 0, twist: 0,
      down: true };
  }

  _follow() {
    const all = [...this._pointers.values()];
    const from = middle(all.map((each) => each.from));
    const at = middle(all.map((each) => each.at));
    this._drag.push = [at[0] - from[0], at[1] - from[1]];
    if (all.length < 2) return;
    const span = spanOf(all.map((each) => each.at));
    this._drag.spread = (span.length - this._laid.length) / 2 || 0.01;
    this._drag.twist = Math.atan2(Math.sin(span.angle - this._laid.angle),
      Math.cos(span.angle - this._laid.angle));
  }
}

function ease(share) {
  return share ** 2 * (3 - 2 * share);
}

function middle(points) {
  return [0, 1].map((i) => points.reduce((sum, point) => sum + point[i], 0) / points.length);
}

function spanOf([first, second]) {
  if (!second) return { length: 0, angle: 0 };
  const [x, y] = [second[0] - first[0], second[1] - first[1]];
  return { length: Math.hypot(x, y), angle: Math.atan2(y, x) };
}
