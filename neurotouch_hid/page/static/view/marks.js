// Marks that can be dragged: thresholds and ends of ranges in the bars, ends and bend of a curve.
//
// Each is a slider for the keyboard and for screen readers. A dragged mark is saved when it is
// released; keys save after a short pause, and the mark stays with the person until then. All marks
// of one value move together. `moved` bubbles from a mark that a person moves, `letgo` from one
// that was released and needs no saving.

import { element } from "../shared/wire.js";

const NAMES = {
  on_mm: "acts from", off_mm: "releases below", rest: "begins at", full: "ends at",
  expo: "bend", power: "bend",
};
const SHORT = {
  on_mm: "on", off_mm: "off", rest: "rest", full: "full", expo: "bend", power: "bend",
};
const LIMITS = {
  on_mm: [1, 18], off_mm: [0.5, 17], rest: [0, 17], full: [1, 30], expo: [-1, 1], power: [0.2, 5],
};
const THRESHOLDS = ["off_mm", "on_mm"]; // above a bar; ends of ranges are below it
const SAVE_MS = 700;
const APART_PX = 40; // the centres of two handles: a handle is at most 36 px wide
const movers = new WeakMap(); // functions that show another value, by mark

export function listMarks(binding) {
  return ["on_mm", "off_mm", "rest", "full"].filter((name) => name in binding);
}

// `where` distinguishes the marks of one binding in several places: "Push left", "Curve".
export function nameMark(binding, mark, where = "") {
  const name = `${binding.when} → ${binding.do}: ${NAMES[mark]}`;
  return where ? `${where}, ${name}` : name;
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

// Shows a value in every mark of it.
export function showValue(key, mark, value) {
  const same = `.mark[data-key="${CSS.escape(key)}"][data-mark="${mark}"]`;
  for (const each of document.querySelectorAll(same)) movers.get(each)(value);
}

// The rows of marks of a bar: each binding has its own, so that no mark covers another one.
export function makeRows(box, bindings, make) {
  const sides = { up: 0, down: 0 };
  const rows = [];
  for (const binding of bindings) {
    for (const side of ["up", "down"]) {
      const marks = listMarks(binding).filter((mark) =>
        THRESHOLDS.includes(mark) === (side === "up"));
      if (!marks.length) continue;
      const row = element("span", { class: `mark-row ${side}` });
      row.style.setProperty("--row", sides[side]++);
      row.append(...marks.map((mark) => make(binding, mark)));
      rows.push([row, side, binding]);
    }
  }
  for (const [row, side, binding] of rows) {
    if (sides[side] > 1) {
      row.append(element("span", { class: "row-name", "data-long": `${binding.when} → ${binding.do}`,
        "data-short": `→ ${binding.do}` }));
    }
  }
  box.replaceChildren(...rows.map(([row]) => row));
  box.parentElement.style.setProperty("--up", sides.up);
  box.parentElement.style.setProperty("--down", sides.down);
  layOut(box);
}

// Moves handles of one row apart that would cover each other; a line leads to the true place.
export function layOut(box) {
  for (const row of box.querySelectorAll(".mark-row")) {
    const { width } = row.getBoundingClientRect();
    if (!width) continue;
    const marks = [...row.querySelectorAll(".mark")].map((mark) =>
      ({ mark, at: (width * parseFloat(mark.style.left)) / 100 })).sort((a, b) => a.at - b.at);
    const centres = spread(marks.map(({ at }) => at), width);
    marks.forEach(({ mark, at }, i) => mark.style.setProperty("--aside", `${centres[i] - at}px`));
    const name = row.querySelector(".row-name");
    if (name) placeName(name, centres, width);
  }
}

function spread(places, width) {
  const half = APART_PX / 2;
  const centres = [];
  places.forEach((at, i) => centres.push(Math.max(at, i ? centres[i - 1] + APART_PX : half)));
  const middle = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;
  const back = Math.max(middle(centres) - middle(places), centres.at(-1) + half - width, 0);
  let least = half;
  return centres.map((centre) => {
    const moved = Math.max(centre - back, least);
    least = moved + APART_PX;
    return moved;
  });
}

// The name of a row is behind its handles, or before them if there is more room.
function placeName(name, centres, width) {
  const before = centres[0] - APART_PX / 2;
  const behind = width - centres.at(-1) - APART_PX / 2;
  name.style.left = behind >= before ? `${width - behind}px` : "0";
  name.style.maxWidth = `${Math.max(behind, before)}px`;
  name.textContent = name.dataset.long;
  if (name.scrollWidth > name.clientWidth) name.textContent = name.dataset.short;
}

const isHeld = () => document.querySelector(".mark.held") !== null;
const observer = new ResizeObserver((seen) => {
  if (!isHeld()) for (const { target } of seen) layOut(target);
});

// Keeps the marks of a box in their places whatever its width becomes.
export function watchWidth(box) {
  observer.observe(box);
}

// A mark in a box: `place(value)` is its place as a share of the box, `read(x, y)` the value at
// a share. `save(value)` once it is released.
export function makeMark({ binding, mark, value, box, place, read, save, edit, where }) {
  const handle = element("span", { class: `mark mark-${mark}`, text: SHORT[mark] });
  const name = nameMark(binding, mark, where);
  let now = value;
  let saved = value;
  let timer = 0;
  let readAt = null; // the value at a pointer; only its way counts, for the page may move meanwhile
  const isBend = mark === "expo" || mark === "power";
  const unit = isBend ? "" : " mm";

  function show(next) {
    now = next;
    const [x, y] = place(next);
    handle.style.left = `${100 * x}%`;
    if (y !== null) handle.style.top = `${100 * y}%`;
    handle.title = `${name} ${next}${unit}`;
    if (edit) {
      handle.setAttribute("aria-valuenow", next);
      handle.setAttribute("aria-valuetext", `${next}${unit}`);
    }
  }
  movers.set(handle, (next) => {
    show(next);
    if (!handle.classList.contains("held")) saved = next;
  });

  if (edit && binding.key !== null) {
    const ends = LIMITS[mark].map((end) => limit(binding, mark, end));
    for (const [key, setting] of Object.entries({
      role: "slider", tabindex: 0, "aria-label": name, "aria-valuemin": ends[0],
      "aria-valuemax": ends[1], "data-key": binding.key, "data-mark": mark,
    })) handle.setAttribute(key, setting);
    handle.classList.add("draggable");
    const move = (next) => {
      showValue(binding.key, mark, limit(binding, mark, next));
      handle.dispatchEvent(new CustomEvent("moved",
        { bubbles: true, detail: { key: binding.key, mark, value: now } }));
    };
    handle.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      handle.focus();
      handle.setPointerCapture(event.pointerId);
      handle.classList.add("held");
      const { width, height } = box.getBoundingClientRect();
      const [x, y] = place(now);
      const from = { x: x - event.clientX / width, y: (y ?? 0) - event.clientY / height };
      readAt = ({ clientX, clientY }) => read(from.x + clientX / width, from.y + clientY / height);
    });
    handle.addEventListener("pointermove", (event) => {
      if (handle.hasPointerCapture(event.pointerId)) move(readAt(event));
    });
    const release = () => {
      handle.classList.remove("held");
      for (const row of document.querySelectorAll(".marks, .handles")) layOut(row);
      if (now !== saved) save(saved = now);
      else handle.dispatchEvent(new Event("letgo", { bubbles: true }));
    };
    handle.addEventListener("lostpointercapture", release); // released, or ended by a scroll
    handle.addEventListener("keydown", (event) => {
      const size = isBend ? 0.05 : 0.1;
      const steps = {
        ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10,
        Home: -Infinity, End: Infinity,
      };
      if (!(event.key in steps)) return;
      event.preventDefault();
      handle.classList.add("held");
      move(now + size * steps[event.key]);
      clearTimeout(timer);
      timer = setTimeout(release, SAVE_MS);
    });
  }
  show(value);
  return handle;
}
