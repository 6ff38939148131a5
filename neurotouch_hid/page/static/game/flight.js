// The flight: a ship, rings one after another, and a measured trial of pointing for each ring.
//
// Lengths are in ship lengths, times in seconds. This module does not draw, sound or read a pad.

const BASE_SPEED = 13;
const SPEEDS = [0.2, 2];
export const RINGS = 12;
const TURN_RAD_S = 0.85;
const ROLL_RAD_S = 1.6;
const THRUST_PER_S = 0.7; // of the base speed
const GAP = [62, 84];
const FIRST = 44; // the first ring is near, and one push reaches it
const FIRST_BEND_RAD = 0.26;
const BEND_RAD = 0.42; // largest angle between the ship's course and the next ring
const RADII = [9, 6.5]; // wide and narrow in turn
const DWELL_S = 0.4; // an aim that stays this long counts as a selection
const AHEAD = 3;

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const add = (a, b, k = 1) => [a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]];
const sub = (a, b) => add(a, b, -1);
const cross = (a, b) =>
  [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => { const n = Math.hypot(...a) || 1; return a.map((x) => x / n); };
export const vector = { dot, add, sub, cross, unit };

// Random numbers from a fixed seed, so that flights and pictures can be repeated.
function makeChance(seed) {
  let state = seed >>> 0;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

export class Flight {
  // `steady`: the view never rolls, only the ship leans. `auto`: the ship controls its own speed.
  constructor({ seed = 1, steady = false, auto = false, pace = 1 } = {}) {
    this._chance = makeChance(seed);
    this.steady = steady;
    this.auto = auto;
    this.position = [0, 0, 0];
    this.right = [1, 0, 0];
    this.up = [0, 1, 0];
    this.forward = [0, 0, 1];
    this.pace = pace; // share of the base speed, 20 to 200 %
    this.roll = 0; // rad, total roll of the ship
    this.lean = [0, 0, 0]; // lean that shows the input: pitch, yaw, roll
    this.time = 0;
    this.passed = 0;
    this.missed = 0;
    this.trials = [];
    this.rings = [];
    this._serial = 0;
    while (this.rings.length < AHEAD) this._addRing();
    this._begin();
  }

  get next() {
    return this.rings[0];
  }

  get isOver() {
    return this.passed + this.missed >= RINGS;
  }

  // Returns the event of this step: "passed", "missed" or "".
  advance(control, dt) {
    this.time += dt;
    const before = this.position;
    this._steer(control, dt);
    const speed = BASE_SPEED * this.pace;
    this.position = add(this.position, this.forward, speed * dt);
    this._aim(control, dt);
    const ring = this.next;
    const [was, is] = [before, this.position].map((at) => dot(sub(at, ring.centre), ring.way));
    if (was < 0 && is >= 0) {
      const off = Math.hypot(...this._inPlane(ring, this.position));
      if (off < 2.2 * ring.radius) return this._finish(off <= ring.radius);
    }
    // Passed far from it, or turned back: the next ring is placed on the ship's present course.
    if (is > 8 || Math.hypot(...sub(this.position, ring.centre)) > 2 * GAP[1]) {
      return this._finish(false);
    }
    return "";
  }

  // Returns the direction of the next ring, right and up in rad, and its distance.
  find(ring = this.next) {
    const away = sub(ring.centre, this.position);
    const [x, y, z] = [this.right, this.up, this.forward].map((axis) => dot(away, axis));
    return { right: Math.atan2(x, Math.max(z, 0.1)), up: Math.atan2(y, Math.max(z, 0.1)),
      distance: Math.hypot(x, y, z), behind: z < 0, radius: ring.radius };
  }

  _steer({ pitch, yaw, roll, faster, slower }, dt) {
    const turn = (a, b, angle) => {
      const [c, s] = [Math.cos(angle), Math.sin(angle)];
      return [add(a.map((x) => c * x), b, s), add(b.map((x) => c * x), a, -s)];
    };
    [this.forward, this.right] = turn(this.forward, this.right, yaw * TURN_RAD_S * dt);
    [this.forward, this.up] = turn(this.forward, this.up, pitch * TURN_RAD_S * dt);
    this.roll += roll * ROLL_RAD_S * dt;
    if (!this.steady) [this.up, this.right] = turn(this.up, this.right, roll * ROLL_RAD_S * dt);
    this.forward = unit(this.forward);
    this.right = unit(cross(this.up, this.forward));
    this.up = cross(this.forward, this.right);
    const shown = [pitch, yaw, roll];
    this.lean = this.lean.map((x, i) => x + (shown[i] - x) * Math.min(1, 7 * dt));
    let wanted = this.pace + (faster - slower) * THRUST_PER_S * dt;
    if (this.auto) {
      // Slow before a large turn, so that pushes alone are enough.
      const { right, up } = this.find();
      const aim = 1.1 - 1.6 * Math.min(Math.hypot(right, up), 0.5);
      wanted = this.pace + Math.min(Math.max(aim - this.pace, -dt), dt) * 0.8;
    }
    this.pace = Math.min(Math.max(wanted, SPEEDS[0]), SPEEDS[1]);
  }

  // Returns the point at which the ship would cross the ring's plane on its present course.
  _project(ring) {
    const closing = dot(this.forward, ring.way);
    if (closing < 0.2) return null;
    const far = dot(sub(ring.centre, this.position), ring.way) / closing;
    return this._inPlane(ring, add(this.position, this.forward, far));
  }

  _inPlane(ring, point) {
    const away = sub(point, ring.centre);
    return [dot(away, ring.side), dot(away, ring.top)];
  }

  _begin() {
    const start = this._project(this.next);
    this._trial = start && { start, begun: null, inside: 0, done: false };
  }

  // A ring is a target, the ship's course the pointer: a trial of ISO 9241-411.
  _aim({ pitch, yaw }, dt) {
    const trial = this._trial;
    if (!trial || trial.done) return;
    if (trial.begun === null) {
      if (Math.hypot(pitch, yaw) < 0.05) return;
      trial.begun = this.time;
    }
    const aim = this._project(this.next);
    const inside = aim && Math.hypot(...aim) <= this.next.radius;
    trial.inside = inside ? trial.inside + dt : 0;
    if (trial.inside >= DWELL_S) this._select(aim, this.time - DWELL_S);
  }

  _select(aim, at) {
    const trial = this._trial;
    trial.done = true;
    const movement_s = at - trial.begun;
    const distance = Math.hypot(...trial.start);
    if (movement_s < 0.05 || distance <= this.next.radius) return; // the ship already aimed at it
    this.trials.push({ width: 2 * this.next.radius, start: trial.start, target: [0, 0],
      selected: aim, movement_s });
  }

  _finish(through) {
    if (this._trial && !this._trial.done && this._trial.begun !== null) {
      const aim = this._inPlane(this.next, this.position);
      if (Math.hypot(...aim) < 6 * this.next.radius) this._select(aim, this.time);
    }
    const old = this.rings.shift();
    if (through) {
      this.passed += 1;
    } else {
      this.missed += 1;
      this.rings = []; // the course comes to the ship
    }
    this.gone = { ...old, through, at: this.time };
    while (this.rings.length < AHEAD) this._addRing();
    this._begin();
    return through ? "passed" : "missed";
  }

  _addRing() {
    const last = this.rings.at(-1);
    const from = last ? last.centre : this.position;
    const way = last ? last.way : this.forward;
    const side = last ? last.side : this.right;
    const top = last ? last.top : this.up;
    const angle = 2 * Math.PI * this._chance();
    const bend = this._serial ? BEND_RAD * (0.35 + 0.65 * this._chance()) : FIRST_BEND_RAD;
    const turned = unit(add(add(way.map((x) => Math.cos(bend) * x),
      side, Math.sin(bend) * Math.cos(angle)), top, Math.sin(bend) * Math.sin(angle)));
    const gap = GAP[0] + (GAP[1] - GAP[0]) * this._chance();
    const far = this._serial ? gap : FIRST;
    const newSide = unit(cross(top, turned));
    this.rings.push({
      centre: add(from, turned, far), way: turned, side: newSide, top: cross(turned, newSide),
      radius: RADII[this._serial % 2], number: (this._serial += 1),
    });
  }
}
