// The response curve of a binding, with the hand's present point and those of the last 30 s.

import { colour, element, prepareCanvas, showOptions } from "../shared/wire.js";
import { layOut, makeMark, watchWidth } from "./marks.js";

const KEPT_MS = 30000;
const BENDS = { expo: [0.875, 0.125], power: [0.9659, 0.0313] }; // values at half way, steepest ends

export function makeCurve({ canvas, handles, select, save, words }) {
  let bindings = [];
  let chosen = 0;
  let byHand = false; // the person has chosen a binding; until then the gesture chooses it
  let cloud = [];

  watchWidth(handles);
  select.addEventListener("change", () => {
    byHand = true;
    choose(Number(select.value));
  });

  function choose(index) {
    if (index === chosen) return;
    chosen = index;
    cloud = [];
    select.value = String(index);
    showHandles();
  }

  let edit = false;
  function showBindings(layer, mayEdit) {
    edit = mayEdit;
    bindings = (layer ? layer.bindings : []).filter((binding) => binding.samples);
    showOptions(select, bindings.map((binding, i) =>
      [String(i), `${binding.when} → ${binding.do}`]));
    if (chosen >= bindings.length) chosen = 0;
    select.value = String(chosen);
    select.hidden = !bindings.length;
    cloud = [];
    showHandles();
  }

  function showHandles() {
    handles.replaceChildren();
    const binding = bindings[chosen];
    if (!binding) return;
    const make = (mark, value, place, read) => makeMark({
      binding, mark, value, edit, box: handles, where: "Curve", place, read,
      save: (next) => save(binding.key, mark, next),
    });
    const makeEnd = (mark) => make(mark, binding[mark],
      (mm) => [Math.min(mm / binding.most, 1), null], (x) => x * binding.most);
    const [mark] = Object.keys(binding.curve);
    if (mark in BENDS) {
      const middle = (binding.rest + binding.full) / 2 / binding.most;
      handles.append(make(mark, binding.curve[mark],
        (bend) => [middle, 1 - bendToValue(mark, bend)], (_, y) => valueToBend(mark, 1 - y)));
    }
    handles.append(element("span", { class: "mark-row down" }, makeEnd("rest"), makeEnd("full")));
    layOut(handles);
  }

  function show(state, now) {
    const gesture = state.gesture;
    const isEdited = handles.contains(document.activeElement); // the person holds it, so it must stay
    if (!byHand && !isEdited && gesture.movement !== "none") {
      const found = bindings.findIndex((each) => each.movements.includes(gesture.movement));
      if (found >= 0) choose(found);
    }
    const binding = bindings[chosen];
    let point = null;
    if (binding && binding.movements.includes(gesture.movement)) {
      point = [gesture.felt_mm, readOutput(binding, state.pad.axes)];
      cloud.push([now, ...point]);
    }
    while (cloud.length && now - cloud[0][0] > KEPT_MS) cloud.shift();
    draw(binding, point);
    if (words) words(binding, point);
  }

  function draw(binding, point) {
    const { context, width, height } = prepareCanvas(canvas);
    context.strokeStyle = colour("line");
    context.lineWidth = 1;
    context.strokeRect(0.5, 0.5, width - 1, height - 1);
    if (!binding) return;
    const x = (mm) => (mm / binding.most) * width;
    const y = (value) => (1 - value) * (height - 2) + 1;
    context.fillStyle = colour("cloud");
    for (const [, mm, value] of cloud) context.fillRect(x(mm) - 1.5, y(value) - 1.5, 3, 3);
    context.strokeStyle = colour("accent");
    context.lineWidth = 2.5;
    context.beginPath();
    binding.samples.forEach((value, i) => {
      const mm = (binding.most * i) / (binding.samples.length - 1);
      context[i ? "lineTo" : "moveTo"](x(mm), y(value));
    });
    context.stroke();
    if (!point) return;
    context.beginPath();
    context.arc(x(point[0]), y(point[1]), 7, 0, 2 * Math.PI);
    context.fillStyle = colour("warm");
    context.fill();
    context.lineWidth = 2;
    context.strokeStyle = colour("page");
    context.stroke();
  }

  return { show, showBindings };
}

function readOutput(binding, axes) {
  const words = binding.do.split(" ");
  const names = words[0] === "stick" ? [`${words[1]}_x`, `${words[1]}_y`]
    : words[0] === "axis" ? [words[1]] : [`${words[1]}_trigger`];
  return Math.min(Math.hypot(...names.map((name) => axes[name] || 0)), 1);
}

function bendToValue(mark, bend) {
  if (mark === "power") return 0.5 ** bend;
  if (bend >= 0) return 0.5 - 0.375 * bend;
  return invert((x) => x * (1 + bend - bend * x * x), 0.5);
}

function valueToBend(mark, value) {
  if (mark === "power") return Math.log(Math.min(Math.max(value, 0.04), 0.9)) / Math.log(0.5);
  if (value <= 0.5) return (0.5 - value) / 0.375;
  return -invert((bend) => bendToValue("expo", -bend) - 0.5, value - 0.5);
}

// The x of 0..1 at which a rising function has a value.
function invert(rising, value) {
  let [low, high] = [0, 1];
  for (let i = 0; i < 30; i++) {
    const middle = (low + high) / 2;
    if (rising(middle) < value) low = middle;
    else high = middle;
  }
  return (low + high) / 2;
}
