// Marks that can be dragged: thresholds and ends of ranges in the bars, ends and bend of a curve.
//
// Each is a slider for the keyboard and for screen readers. Nothing is saved while it is dragged,
// only where it is let go; keys save after a short pause, and until then hold the mark too.
// `letgo` bubbles from a mark that was held and needs no saving.

import { element } from "./wire.js";

const NAMES = {
  on_mm: "acts from", off_mm: "lets go below", rest: "begins at", full: "ends at",
  expo: "bend", power: "bend",
};
const SHORT = { on_mm: "on", off_mm: "off", rest: "rest", full: "full" };
const LIMITS = {
  on_mm: [1, 18], off_mm: [0.5, 17], rest: [0, 17], full: [1, 30], expo: [-1, 1], power: [0.2, 5],
};
const SAVE_MS = 700;

export function listMarks(binding) {
  return ["on_mm", "off_mm", "rest", "full"].filter((name) => name in binding);
}

export function nameMark(binding, mark) {
  return `${binding.when} → ${binding.do}: ${NAMES[mark]}`;
}

export function limit(binding, mark, value) {
  let [low, high] = LIMITS[mark];
  if (mark === "on_mm") low = Math.max(low, binding.off_mm + 0.1);
  if (mark === "off_mm") high = Math.min(high, binding.on_mm - 0.1);
  if (mark === "rest") high = Math.min(high, binding.full - 0.5);
  if (mark === "full") low = Math.max(low, binding.rest + 0.5);
  const step = mark === "expo" || mark === "power" ? 100 : 10;
  return Math.round(step * Math.min(Math.max(value, low), high)) / step;
}

// A mark in a box: `place(value)` is where it lies as a share of the box, `read(x, y)` the value at
// a share. `moved(value)` while it goes, `save(value)` once it is let go.
export function makeMark({ binding, mark, value, box, place, read, save, moved, edit }) {
  const handle = element("span", { class: `mark mark-${mark}` });
  handle.append(element("span", { class: "mark-name", text: SHORT[mark] || "" }));
  let now = value;
  let saved = value;
  let timer = 0;
  const unit = mark === "expo" || mark === "power" ? "" : " mm";

  function show(next) {
    now = next;
    const [x, y] = place(next);
    handle.style.left = `${100 * x}%`;
    if (y !== null) handle.style.top = `${100 * y}%`;
    handle.title = `${nameMark(binding, mark)} ${next}${unit}`;
    if (edit) {
      handle.setAttribute("aria-valuenow", next);
      handle.setAttribute("aria-valuetext", `${next}${unit}`);
    }
    if (moved) moved(next);
  }

  if (edit && binding.key !== null) {
    const [low, high] = LIMITS[mark];
    for (const [key, setting] of Object.entries({
      role: "slider", tabindex: 0, "aria-label": nameMark(binding, mark),
      "aria-valuemin": low, "aria-valuemax": high, "data-key": binding.key, "data-mark": mark,
    })) handle.setAttribute(key, setting);
    handle.classList.add("draggable");
    handle.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      handle.focus();
      handle.setPointerCapture(event.pointerId);
      handle.classList.add("held");
    });
    handle.addEventListener("pointermove", (event) => {
      if (!handle.hasPointerCapture(event.pointerId)) return;
      const { left, top, width, height } = box.getBoundingClientRect();
      show(limit(binding, mark,
        read((event.clientX - left) / width, (event.clientY - top) / height)));
    });
    const release = () => {
      handle.classList.remove("held");
      if (now !== saved) save(saved = now);
      else handle.dispatchEvent(new Event("letgo", { bubbles: true }));
    };
    handle.addEventListener("lostpointercapture", release); // let go, or taken away by a scroll
    handle.addEventListener("keydown", (event) => {
      const size = mark === "expo" || mark === "power" ? 0.05 : 0.1;
      const steps = {
        ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10,
      };
      if (!(event.key in steps)) return;
      event.preventDefault();
      handle.classList.add("held");
      show(limit(binding, mark, now + size * steps[event.key]));
      clearTimeout(timer);
      timer = setTimeout(release, SAVE_MS);
    });
  }
  show(value);
  return handle;
}
