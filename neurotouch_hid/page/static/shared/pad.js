// The virtual pad as a picture: sticks, triggers, buttons; pressed ones also in words.

const SVG = "http://www.w3.org/2000/svg";
const BUTTONS = {
  a: [246, 92, "A"], b: [262, 76, "B"], x: [230, 76, "X"], y: [246, 60, "Y"],
  back: [136, 66, "◂"], start: [184, 66, "▸"], guide: [160, 48, "●"],
};
const STICKS = { left: [74, 76], right: [206, 116] };
const TRAVEL = 13;

function draw(name, attributes, text) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text) made.textContent = text;
  return made;
}

// With `choose(part)` a person can choose a part; people who cannot point use the list beside it.
export function makePad(box, words, choose) {
  const svg = draw("svg", { viewBox: "0 0 320 176", "aria-hidden": "true" });
  svg.append(draw("path", { class: "pad-body",
    d: "M74 36h172c34 0 52 30 60 78 5 30-6 48-24 48-22 0-30-32-56-32H94c-26 0-34 32-56 32-18 0-29-18-24-48 8-48 26-78 60-78z" }));
  const parts = {};
  const wells = {}; // larger targets for parts that are too small to click
  for (const [side, x] of [["left", 56], ["right", 228]]) {
    const trigger = draw("rect", { class: "pad-trigger", x, y: 6, width: 36, height: 14, rx: 5 });
    svg.append(trigger);
    wells[`${side}_trigger`] = trigger;
    parts[`${side}_trigger`] = draw("rect",
      { class: "pad-pulled", x, y: 6, width: 0, height: 14, rx: 5 });
    const bumper = side === "left" ? "lb" : "rb";
    parts[bumper] = draw("rect",
      { class: "pad-button", x: x - 4, y: 24, width: 44, height: 9, rx: 4 });
    svg.append(parts[`${side}_trigger`], parts[bumper]);
  }
  for (const [side, [cx, cy]] of Object.entries(STICKS)) {
    wells[side] = draw("circle", { class: "pad-well", cx, cy, r: 22 });
    svg.append(wells[side]);
    parts[side] = draw("circle", { class: "pad-stick", cx, cy, r: 12 });
    svg.append(parts[side]);
  }
  for (const [way, [x, y]] of Object.entries(
    { up: [108, 98], down: [108, 122], left: [96, 110], right: [120, 110] })) {
    parts[`dpad_${way}`] = draw("rect",
      { class: "pad-button", x, y, width: 12, height: 12, rx: 2 });
    svg.append(parts[`dpad_${way}`]);
  }
  for (const [name, [cx, cy, label]] of Object.entries(BUTTONS)) {
    parts[name] = draw("circle", { class: "pad-button", cx, cy, r: name.length > 1 ? 7 : 9 });
    svg.append(parts[name],
      draw("text", { class: "pad-label", x: cx, y: cy + 3.5, "text-anchor": "middle" }, label));
  }
  for (const [name, part] of choose ? Object.entries(parts) : []) {
    for (const target of [part, wells[name]].filter(Boolean)) {
      target.classList.add("choosable");
      target.addEventListener("click", () => choose(name));
    }
  }
  box.append(svg);

  let said = "";
  return function show({ axes, buttons, keys, mouse }, atRest) {
    for (const side of ["left", "right"]) {
      const [cx, cy] = STICKS[side];
      parts[side].setAttribute("cx", cx + TRAVEL * (axes[`${side}_x`] || 0));
      parts[side].setAttribute("cy", cy + TRAVEL * (axes[`${side}_y`] || 0));
      parts[side].classList.toggle("on",
        buttons.includes(side === "left" ? "ls" : "rs"));
      parts[`${side}_trigger`].setAttribute("width", 36 * (axes[`${side}_trigger`] || 0));
    }
    for (const name of [...Object.keys(BUTTONS), "lb", "rb"]) {
      parts[name].classList.toggle("on", buttons.includes(name));
    }
    const [x, y] = [axes.dpad_x || 0, axes.dpad_y || 0];
    parts.dpad_left.classList.toggle("on", x < 0);
    parts.dpad_right.classList.toggle("on", x > 0);
    parts.dpad_up.classList.toggle("on", y < 0);
    parts.dpad_down.classList.toggle("on", y > 0);
    const pressed = [
      ...buttons.map((name) => name.toUpperCase()),
      ...(x || y ? ["D-pad"] : []),
      ...keys.map((key) => key.replace("KEY_", "").toLowerCase()),
      ...mouse.map((key) => key.replace("BTN_", "mouse ").toLowerCase()),
    ].join(", ") + (atRest ? " (held without a gesture)" : "");
    const sentence = pressed.startsWith(" ") || !pressed ? "nothing" : pressed;
    if (sentence !== said) words.textContent = said = sentence;
  };
}
