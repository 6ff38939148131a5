// Pilots: the gel's pad through the browser's Gamepad API, the stream, or a script.

const STILL = 0.05;

// Standard mapping: axes 0 and 1 are the left stick, 2 and 3 the right one, buttons 6 and 7 the
// triggers.
export function readGamepad() {
  const pads = navigator.getGamepads ? [...navigator.getGamepads()].filter(Boolean) : [];
  const pad = pads.find((each) => each.mapping === "standard");
  if (!pad) return null;
  return {
    name: pad.id,
    left_x: pad.axes[0], left_y: pad.axes[1], right_x: pad.axes[2],
    left_trigger: pad.buttons[6].value, right_trigger: pad.buttons[7].value,
  };
}

export function readStream(state) {
  if (!state) return null;
  const value = (name) => state.pad.axes[name] || 0;
  return {
    name: "stream",
    left_x: value("left_x"), left_y: value("left_y"), right_x: value("right_x"),
    left_trigger: value("left_trigger"), right_trigger: value("right_trigger"),
  };
}

export const REST = { pitch: 0, yaw: 0, roll: 0, faster: 0, slower: 0 };

// Turns a pad's state into the ship's controls: a push up lifts the nose, unless `pull` is chosen.
export function steer(pad, { pull = false, pushOnly = false } = {}) {
  if (!pad) return REST;
  const quiet = (value) => (Math.abs(value) < STILL ? 0 : value);
  return {
    yaw: quiet(pad.left_x),
    pitch: (pull ? 1 : -1) * quiet(pad.left_y),
    roll: pushOnly ? 0 : quiet(pad.right_x),
    faster: pushOnly ? 0 : quiet(pad.right_trigger),
    slower: pushOnly ? 0 : quiet(pad.left_trigger),
  };
}

const WAYS = ["right", "up-right", "up", "up-left", "left", "down-left", "down", "down-right"];

// Returns the gesture that leads to the next ring, in words.
export function adviseGesture({ right, up, distance, radius, behind }, pull = false) {
  if (behind) return "Push to either side";
  const off = Math.hypot(right, up);
  if (off < Math.atan2(0.6 * radius, distance)) return "Straight on";
  const way = WAYS[((Math.round(Math.atan2(pull ? -up : up, right) / (Math.PI / 4)) % 8) + 8) % 8];
  return `Push ${way}`;
}

// The attract mode: a script of gestures in mm, mapped to the pad as a profile would.
const SHOW = [
  { until: 1.2, gesture: "zoom", mm: 3.5 },
  { until: 5.0, gesture: "push" },
  { until: 6.0, gesture: "twist_cw", mm: 6 },
  { until: 9.0, gesture: "push" },
  { until: 10.0, gesture: "pinch", mm: 4.5 },
  { until: 13.0, gesture: "push" },
  { until: 14.0, gesture: "twist_ccw", mm: 6 },
  { until: 16.0, gesture: "push" },
];
const LENGTH_S = SHOW.at(-1).until;
const FULL_MM = { push: 8, twist_cw: 7, twist_ccw: 7, zoom: 4.5, pinch: 7 };

export function playScript(flight) {
  const t = flight.time % LENGTH_S;
  const { gesture, mm } = SHOW.find(({ until }) => t < until);
  const share = (value) => Math.min(Math.max((value - 1) / (FULL_MM[gesture] - 1), 0), 1);
  const pad = { name: "script", left_x: 0, left_y: 0, right_x: 0, left_trigger: 0,
    right_trigger: 0 };
  let words = "";
  if (gesture === "push") {
    const { right, up } = flight.find();
    const off = Math.hypot(right, up);
    const size = Math.min(16 * off + 1, 8);
    if (off > 0.02) {
      pad.left_x = share(size) * (right / off);
      pad.left_y = -share(size) * (up / off);
      const way = WAYS[((Math.round(Math.atan2(up, right) / (Math.PI / 4)) % 8) + 8) % 8];
      words = `Push ${way} ${size.toFixed(1)} mm`;
    } else {
      words = "At rest";
    }
  } else {
    const side = { twist_cw: ["right_x", 1], twist_ccw: ["right_x", -1],
      zoom: ["right_trigger", 1], pinch: ["left_trigger", 1] }[gesture];
    pad[side[0]] = side[1] * share(mm);
    const name = { twist_cw: "Twist clockwise", twist_ccw: "Twist counter-clockwise",
      zoom: "Zoom", pinch: "Pinch" }[gesture];
    words = `${name} ${mm.toFixed(1)} mm`;
  }
  return { pad, words };
}
