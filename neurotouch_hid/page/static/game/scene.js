// Draws sky, stars, rings and ship. Every colour has a shape with the same meaning.

import { vector } from "./flight.js";

const { add, dot, sub } = vector;
const STARS = 700;
const FIELD = 170;
const NEAR = 0.8;
const SEGMENTS = 120;
const SHIP_SIZE = 0.64;
const PLANET = [0.42, -0.2, 0.88];
const SHIP = [
  // the ship's faces: points right, up, forward, and how light they are
  { points: [[0, 0.1, 1.7], [-1.5, -0.08, -0.8], [-0.3, 0.2, -0.6]], light: 0.92 },
  { points: [[0, 0.1, 1.7], [0.3, 0.2, -0.6], [1.5, -0.08, -0.8]], light: 0.78 },
  { points: [[0, 0.1, 1.7], [-0.3, 0.2, -0.6], [0, 0.46, -0.72]], light: 1 },
  { points: [[0, 0.1, 1.7], [0, 0.46, -0.72], [0.3, 0.2, -0.6]], light: 0.86 },
  { points: [[-0.3, 0.2, -0.6], [0, 0.46, -0.72], [0.3, 0.2, -0.6], [0, -0.02, -0.55]], light: 0.4 },
];

export class Scene {
  constructor(canvas) {
    this._canvas = canvas;
    this._stars = Array.from({ length: STARS }, (_, i) => {
      const random = (k) => (Math.sin(12.9898 * (i + 1) + 78.233 * k) * 43758.5453) % 1;
      return [0, 1, 2].map((k) => FIELD * random(k + 1)).concat(0.4 + Math.abs(random(4)));
    });
    this._sky = null;
    this.contrast = matchMedia("(prefers-contrast: more), (forced-colors: active)").matches;
  }

  draw(flight, { calm = false } = {}) {
    const context = this._fit();
    const view = this._makeView(flight);
    this._drawSky(context, flight, calm);
    this._drawStars(context, view, flight, calm);
    for (const ring of [...flight.rings].reverse()) {
      this._drawRing(context, view, ring, ring === flight.next);
    }
    if (flight.gone && flight.gone.through && flight.time - flight.gone.at < 0.8) {
      this._drawGlow(context, (flight.time - flight.gone.at) / 0.8, calm);
    }
    this._drawArrow(context, flight);
    this._drawShip(context, view, flight);
  }

  _fit() {
    const canvas = this._canvas;
    const ratio = Math.min(devicePixelRatio || 1, 2);
    const { width, height } = canvas.getBoundingClientRect();
    const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (canvas.width !== w || canvas.height !== h) {
      canvas.width = w;
      canvas.height = h;
      this._sky = null;
    }
    this._width = width;
    this._height = height;
    const context = canvas.getContext("2d", { alpha: false });
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    return context;
  }

  // The camera follows a little behind and above.
  _makeView(flight) {
    const eye = add(add(flight.position, flight.forward, -6.5), flight.up, 2.1);
    const focus = 0.95 * Math.min(this._width, 1.4 * this._height);
    return {
      eye, focus, flight,
      see: (point) => {
        const away = sub(point, eye);
        return [flight.right, flight.up, flight.forward].map((axis) => dot(away, axis));
      },
      project: ([x, y, z]) => [this._width / 2 + (focus * x) / z,
        0.47 * this._height - (focus * y) / z],
    };
  }

  _drawSky(context, flight, calm) {
    const [w, h] = [this._width, this._height];
    if (this.contrast) {
      context.fillStyle = "#000000";
      context.fillRect(0, 0, w, h);
      return;
    }
    if (!this._sky) {
      this._sky = context.createLinearGradient(0, 0, 0, h);
      this._sky.addColorStop(0, "#070b18");
      this._sky.addColorStop(0.55, "#0f1b34");
      this._sky.addColorStop(1, "#1a2b45");
    }
    context.fillStyle = this._sky;
    context.fillRect(0, 0, w, h);
    // Two soft clouds of gas that stay where they are among the stars.
    for (const [way, tint] of [[[0.5, 0.25, 0.83], "84, 118, 190"], [[-0.62, -0.1, 0.78],
      "38, 130, 130"], [[0.1, 0.4, -0.9], "120, 90, 160"]]) {
      const [x, y, z] = [flight.right, flight.up, flight.forward].map((axis) => dot(way, axis));
      if (z < 0.15) continue;
      const [cx, cy] = [w / 2 + (0.9 * w * x) / z, 0.47 * h - (0.9 * w * y) / z];
      const cloud = context.createRadialGradient(cx, cy, 0, cx, cy, 0.55 * w);
      cloud.addColorStop(0, `rgba(${tint}, ${calm ? 0.14 : 0.24})`);
      cloud.addColorStop(1, `rgba(${tint}, 0)`);
      context.fillStyle = cloud;
      context.fillRect(0, 0, w, h);
    }
    this._drawPlanet(context, flight);
  }

  // Far away, so that it only turns with the view, and the pilot sees the turn.
  _drawPlanet(context, flight) {
    const [w, h] = [this._width, this._height];
    const [x, y, z] = [flight.right, flight.up, flight.forward].map((axis) => dot(PLANET, axis));
    if (z < 0.2) return;
    const [cx, cy] = [w / 2 + (0.95 * w * x) / z, 0.47 * h - (0.95 * w * y) / z];
    const size = 0.085 * w;
    const halo = context.createRadialGradient(cx, cy, 0.9 * size, cx, cy, 1.35 * size);
    halo.addColorStop(0, "rgba(130, 180, 235, 0.28)");
    halo.addColorStop(1, "rgba(130, 180, 235, 0)");
    context.fillStyle = halo;
    context.beginPath();
    context.arc(cx, cy, 1.35 * size, 0, 2 * Math.PI);
    context.fill();
    const day = context.createRadialGradient(cx - 0.5 * size, cy - 0.55 * size, 0.1 * size,
      cx - 0.1 * size, cy - 0.1 * size, 1.15 * size);
    day.addColorStop(0, "#e9c9a4");
    day.addColorStop(0.45, "#a9745e");
    day.addColorStop(0.8, "#3b2c3f");
    day.addColorStop(1, "#141a2e");
    context.fillStyle = day;
    context.beginPath();
    context.arc(cx, cy, size, 0, 2 * Math.PI);
    context.fill();
  }

  _drawStars(context, view, flight, calm) {
    const wrap = (x) => x - 2 * FIELD * Math.round(x / (2 * FIELD));
    const trail = calm ? 0 : 0.035 * flight.pace * 13;
    context.lineCap = "round";
    for (const [sx, sy, sz, size] of this._stars) {
      const away = [wrap(sx - view.eye[0]), wrap(sy - view.eye[1]), wrap(sz - view.eye[2])];
      const [x, y, z] = [flight.right, flight.up, flight.forward].map((axis) => dot(away, axis));
      if (z < NEAR) continue;
      const fade = Math.min(1, (1.4 * FIELD - z) / FIELD);
      if (fade <= 0) continue;
      const [px, py] = view.project([x, y, z]);
      const [qx, qy] = view.project([x, y, z + trail]);
      context.strokeStyle = `rgba(225, 236, 255, ${(fade * Math.min(size, 1)).toFixed(3)})`;
      context.lineWidth = Math.min(0.9 + (60 * size) / z, 3.2);
      context.beginPath();
      context.moveTo(px, py);
      context.lineTo(qx + 0.01, qy);
      context.stroke();
    }
  }

  _drawRing(context, view, ring, isNext) {
    const rim = (radius) => {
      const points = [];
      for (let i = 0; i <= SEGMENTS; i++) {
        const angle = (2 * Math.PI * i) / SEGMENTS;
        points.push(view.see(add(add(ring.centre, ring.side, radius * Math.cos(angle)),
          ring.top, radius * Math.sin(angle))));
      }
      return points;
    };
    const centre = view.see(ring.centre);
    if (centre[2] < -20) return;
    const near = Math.max(centre[2], 4);
    const fade = Math.max(0.12, Math.min(1, 1.25 - near / 230));
    const stroke = (points, width, style) => {
      context.strokeStyle = style;
      context.lineWidth = width;
      context.beginPath();
      let open = false;
      for (const point of points) {
        if (point[2] < NEAR) { open = false; continue; }
        const [x, y] = view.project(point);
        context[open ? "lineTo" : "moveTo"](x, y);
        open = true;
      }
      context.stroke();
    };
    const thick = Math.min((view.focus * 0.42) / near, 13);
    const tint = isNext ? "126, 240, 220" : "150, 176, 214";
    const outer = rim(ring.radius);
    if (!this.contrast && isNext) {
      stroke(outer, 3.4 * thick, `rgba(${tint}, ${(0.1 * fade).toFixed(3)})`);
      stroke(outer, 2 * thick, `rgba(${tint}, ${(0.2 * fade).toFixed(3)})`);
    }
    stroke(outer, Math.max(thick, 1.2), `rgba(${tint}, ${(isNext ? fade : 0.5 * fade).toFixed(3)})`);
    if (!isNext) return;
    // The next ring has a second rim and four studs: its shape marks it, not only its colour.
    stroke(rim(0.86 * ring.radius), Math.max(0.3 * thick, 1),
      `rgba(255, 255, 255, ${(0.75 * fade).toFixed(3)})`);
    for (let k = 0; k < 4; k++) {
      const angle = (Math.PI * k) / 2 + Math.PI / 4;
      const at = view.see(add(add(ring.centre, ring.side, ring.radius * Math.cos(angle)),
        ring.top, ring.radius * Math.sin(angle)));
      if (at[2] < NEAR) continue;
      const [x, y] = view.project(at);
      context.fillStyle = `rgba(255, 255, 255, ${fade.toFixed(3)})`;
      context.beginPath();
      context.arc(x, y, Math.max(0.75 * thick, 2), 0, 2 * Math.PI);
      context.fill();
    }
  }

  _drawGlow(context, share, calm) {
    if (calm || this.contrast) return;
    const [w, h] = [this._width, this._height];
    const light = context.createRadialGradient(w / 2, h / 2, 0.1 * h, w / 2, h / 2, 0.75 * w);
    light.addColorStop(0, "rgba(126, 240, 220, 0)");
    light.addColorStop(1, `rgba(126, 240, 220, ${(0.3 * (1 - share) ** 2).toFixed(3)})`);
    context.fillStyle = light;
    context.fillRect(0, 0, w, h);
  }

  // If the ring is out of sight, an arrow at the edge points to it.
  _drawArrow(context, flight) {
    const { right, up, behind } = flight.find();
    if (!behind && Math.abs(right) < 0.5 && Math.abs(up) < 0.38) return;
    const angle = Math.atan2(-up, right);
    const [w, h] = [this._width, this._height];
    context.save();
    context.translate(w / 2 + 0.4 * w * Math.cos(angle), h / 2 + 0.38 * h * Math.sin(angle));
    context.rotate(angle);
    context.fillStyle = "#ffd08a";
    context.beginPath();
    context.moveTo(22, 0);
    context.lineTo(-12, 15);
    context.lineTo(-4, 0);
    context.lineTo(-12, -15);
    context.fill();
    context.restore();
  }

  _drawShip(context, view, flight) {
    const [pitch, yaw, roll] = flight.lean;
    const bank = 0.55 * yaw + (flight.steady ? flight.roll : 0.6 * roll);
    const [cb, sb] = [Math.cos(bank), Math.sin(bank)];
    const [cy, sy] = [Math.cos(0.28 * yaw), Math.sin(0.28 * yaw)];
    const [cp, sp] = [Math.cos(0.25 * pitch), Math.sin(0.25 * pitch)];
    const place = ([x, y, z]) => {
      [x, y] = [cb * x + sb * y, cb * y - sb * x];
      [y, z] = [cp * y + sp * z, cp * z - sp * y];
      [x, z] = [cy * x + sy * z, cy * z - sy * x];
      return view.project([SHIP_SIZE * x, SHIP_SIZE * y - 1.85, SHIP_SIZE * z + 6.5]);
    };
    this._drawFlame(context, place, flight.pace);
    for (const { points, light: shade } of SHIP) {
      const tone = Math.round(70 + 175 * shade);
      context.fillStyle = this.contrast ? "#ffffff"
        : `rgb(${Math.round(0.86 * tone)}, ${Math.round(0.94 * tone)}, ${tone})`;
      context.strokeStyle = this.contrast ? "#000000" : "rgba(10, 18, 34, 0.55)";
      context.lineWidth = 1;
      context.beginPath();
      points.map(place).forEach(([x, y], i) => context[i ? "lineTo" : "moveTo"](x, y));
      context.closePath();
      context.fill();
      context.stroke();
    }
  }

  // The faster the ship, the longer the flame, so that the speed is visible.
  _drawFlame(context, place, pace) {
    const length = 0.5 + 1.1 * pace;
    const [left, right, tip] = [[-0.26, 0.16, -0.62], [0.26, 0.16, -0.62],
      [0, 0.12, -0.6 - length]].map(place);
    const root = [(left[0] + right[0]) / 2, (left[1] + right[1]) / 2];
    const size = Math.hypot(right[0] - left[0], right[1] - left[1]);
    context.save();
    context.globalCompositeOperation = "lighter";
    const glow = context.createRadialGradient(...root, 0, ...root, 1.9 * size);
    glow.addColorStop(0, "rgba(255, 190, 120, 0.75)");
    glow.addColorStop(0.35, "rgba(255, 140, 80, 0.25)");
    glow.addColorStop(1, "rgba(255, 120, 70, 0)");
    context.fillStyle = glow;
    context.beginPath();
    context.arc(...root, 1.9 * size, 0, 2 * Math.PI);
    context.fill();
    const jet = context.createLinearGradient(...root, ...tip);
    jet.addColorStop(0, "rgba(255, 236, 200, 0.95)");
    jet.addColorStop(0.4, "rgba(255, 170, 95, 0.6)");
    jet.addColorStop(1, "rgba(255, 120, 70, 0)");
    context.fillStyle = jet;
    context.beginPath();
    context.moveTo(...left);
    context.lineTo(...tip);
    context.lineTo(...right);
    context.fill();
    context.restore();
  }
}
