// Eight bars: the present size of each movement, its peak, and the marks of its bindings.

import { element } from "../shared/wire.js";
import { makeMark, makeRows, watchWidth } from "./marks.js";

const MOST_MM = 15;
const PEAK_MS = 3000;
const NAMES = {
  push_left: "Push left", push_right: "Push right", push_up: "Push up", push_down: "Push down",
  pinch: "Pinch", zoom: "Zoom", twist_cw: "Twist clockwise", twist_ccw: "Twist counter-clockwise",
};
const SIGNS = {
  push_left: "←", push_right: "→", push_up: "↑", push_down: "↓",
  pinch: "→←", zoom: "←→", twist_cw: "↻", twist_ccw: "↺",
};

export function makeBars(list, save) {
  const bars = {};
  for (const [movement, name] of Object.entries(NAMES)) {
    const fill = element("span", { class: "fill" });
    const peak = element("span", { class: "peak" });
    const marks = element("span", { class: "marks" });
    const track = element("span", { class: "track", role: "meter", "aria-label": name,
      "aria-valuemin": 0, "aria-valuemax": MOST_MM, "aria-valuenow": 0,
      "aria-valuetext": "0 millimetres" }, fill, peak);
    const value = element("span", { class: "value", text: "0.0" });
    const sign = element("span", { class: "sign", "aria-hidden": "true", text: SIGNS[movement] });
    list.append(element("li", { class: "bar", "data-movement": movement },
      element("span", { class: "name" }, sign, name),
      element("span", { class: "lane" }, track, marks), value));
    watchWidth(marks);
    bars[movement] = { fill, peak, marks, track, value, most: 0, until: 0, shown: -1, told: 0 };
  }

  function showMarks(layer, edit) {
    for (const [movement, bar] of Object.entries(bars)) {
      const bindings = (layer ? layer.bindings : []).filter((binding) =>
        binding.movements.includes(movement) && binding.unit !== "mm/s");
      makeRows(bar.marks, bindings, (binding, mark) => makeMark({
        binding, mark, edit, box: bar.marks,
        where: NAMES[movement],
        value: binding[mark],
        place: (mm) => [Math.min(mm / MOST_MM, 1), null],
        read: (x) => x * MOST_MM,
        save: (mm) => save(binding.key, mark, mm),
      }));
    }
  }

  function show(gesture, now) {
    for (const [movement, bar] of Object.entries(bars)) {
      const mm = gesture.movement === movement ? gesture.felt_mm : 0;
      if (mm >= bar.most || now > bar.until) {
        if (mm > 0) bar.until = now + PEAK_MS;
        bar.most = mm;
      }
      const shown = Math.round(10 * mm);
      if (shown !== bar.shown) {
        bar.shown = shown;
        bar.fill.style.transform = `scaleX(${Math.min(mm / MOST_MM, 1)})`;
        bar.value.textContent = mm.toFixed(1);
      }
      bar.peak.style.left = `${100 * Math.min(bar.most / MOST_MM, 1)}%`;
      bar.peak.hidden = bar.most < 0.1;
      if (now - bar.told > 1000) {
        bar.told = now;
        bar.track.setAttribute("aria-valuenow", mm.toFixed(1));
        bar.track.setAttribute("aria-valuetext", `${mm.toFixed(1)} millimetres`);
      }
    }
  }

  return { show, showMarks };
}
