// Draws the gel from above: markers and their motion, contacts and their uncertainty.

import { colour, prepareCanvas } from "./wire.js";

const ARROW = 3; // arrows are three times as long as the motion
const RADIUS_MM = 33;
const UNSURE_MM = 3.4; // mean error of a contact point, from the paper

export function findScale(width, height) {
  return Math.min(width, height) / (2 * RADIUS_MM);
}

export function drawDisc(canvas, state, { arrows = true } = {}) {
  const { context, width, height } = prepareCanvas(canvas);
  const scale = findScale(width, height);
  context.translate(width / 2, height / 2);
  context.scale(scale, scale);
  drawDome(context);
  if (!state) return;
  const { moved, valid } = state;
  const places = findPlaces(state);
  if (arrows) {
    context.lineWidth = 0.45;
    context.strokeStyle = colour("arrow");
    context.beginPath();
    places.forEach(([x, y], i) => {
      const [dx, dy] = [moved[2 * i] / 100, moved[2 * i + 1] / 100];
      if (Math.hypot(dx, dy) < 0.25) return;
      drawArrow(context, x, y, x + ARROW * dx, y + ARROW * dy);
    });
    context.stroke();
  }
  places.forEach(([x, y], i) => {
    const [dx, dy] = [moved[2 * i] / 100, moved[2 * i + 1] / 100];
    context.beginPath();
    context.arc(x + dx, y + dy, valid[i] ? 0.62 : 0.5, 0, 2 * Math.PI);
    if (valid[i]) {
      context.fillStyle = colour("dot");
      context.fill();
    } else {
      context.lineWidth = 0.2;
      context.strokeStyle = colour("faint");
      context.stroke();
    }
  });
  drawMissing(context, state.gel.missing.map((i) => places[i]));
  for (const [x, y] of state.gesture.contacts) drawContact(context, x, y);
}

// Where each marker is on the gel at rest, in mm.
function findPlaces({ places }) {
  return Array.from({ length: places.length / 2 }, (_, i) => [places[2 * i] / 100,
    places[2 * i + 1] / 100]);
}

// A cross where the camera sees no dot.
function drawMissing(context, missing) {
  context.lineWidth = 0.5;
  context.strokeStyle = colour("contact");
  context.beginPath();
  for (const [x, y] of missing) {
    context.moveTo(x - 1.1, y - 1.1);
    context.lineTo(x + 1.1, y + 1.1);
    context.moveTo(x - 1.1, y + 1.1);
    context.lineTo(x + 1.1, y - 1.1);
  }
  context.stroke();
}

function drawDome(context) {
  const light = context.createRadialGradient(-9, -12, 2, 0, 0, 31);
  light.addColorStop(0, colour("gel-light"));
  light.addColorStop(1, colour("gel-dark"));
  context.beginPath();
  context.arc(0, 0, 31, 0, 2 * Math.PI);
  context.fillStyle = light;
  context.fill();
  context.lineWidth = 0.4;
  context.strokeStyle = colour("line");
  context.stroke();
}

function drawArrow(context, x0, y0, x1, y1) {
  const angle = Math.atan2(y1 - y0, x1 - x0);
  const head = Math.min(1.4, 0.5 * Math.hypot(x1 - x0, y1 - y0));
  context.moveTo(x0, y0);
  context.lineTo(x1, y1);
  for (const turn of [-0.45, 0.45]) {
    context.moveTo(x1, y1);
    context.lineTo(x1 - head * Math.cos(angle + turn), y1 - head * Math.sin(angle + turn));
  }
}

function drawContact(context, x, y) {
  context.strokeStyle = colour("contact");
  context.lineWidth = 0.5;
  context.setLineDash([1.4, 1]);
  context.beginPath();
  context.arc(x, y, UNSURE_MM, 0, 2 * Math.PI);
  context.stroke();
  context.setLineDash([]);
  context.beginPath();
  context.arc(x, y, 1.1, 0, 2 * Math.PI);
  context.fillStyle = colour("contact");
  context.fill();
}
