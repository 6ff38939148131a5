// The time of a recording: all of it in a thin row, and the seconds around the present moment.

import { colour, prepareCanvas } from "../shared/wire.js";

const COLOURS = ["#8b98a5", "#3f8fd2", "#d9622b", "#2f9e63", "#9c6ade", "#c9a106"];
const NEAR_MS = 12_000;
const GRAB_PX = 6;

// `go` is called with a moment; `reach` with a range of moments and a type, after a person has
// dragged the end of a label. `begin` takes the recording, `show` the present moment and labels.
export function makeTimeline({ whole, near, bar, go, reach }) {
  let times = [];
  let recording = null;
  let shown = null;
  let dragged = null;

  const span = () => Math.max(times.at(-1) - times[0], 1);
  // The seconds around the moment; at both ends of the recording the window stays inside.
  function range() {
    if (dragged) return dragged.window;
    const wide = Math.min(NEAR_MS, span());
    const from = Math.max(times[0], Math.min(times[shown.k] - wide / 2, times.at(-1) - wide));
    return [from, from + wide];
  }

  function drawRow(context, kinds, width, [from, to], top, height) {
    const place = (ms) => ((ms - from) / (to - from)) * width;
    for (let i = 0; i < times.length;) {
      let j = i;
      while (j + 1 < times.length && kinds[j + 1] === kinds[i]) j += 1;
      const right = place(times[Math.min(j + 1, times.length - 1)]);
      const left = place(times[i]);
      if (kinds[i] !== "-" && right >= 0 && left <= width) {
        context.fillStyle = COLOURS[kinds[i]];
        const isRest = kinds[i] === "0";
        context.fillRect(left, top + (isRest ? height - 4 : 0), Math.max(right - left, 1.5),
          isRest ? 4 : height);
      }
      i = j + 1;
    }
  }

  function draw() {
    if (!shown) return;
    const all = prepareCanvas(whole);
    const ends = [times[0], times[0] + span()];
    drawRow(all.context, recording.proposals, all.width, ends, 2, 12);
    drawRow(all.context, shown.sheet.kinds, all.width, ends, 18, 14);
    drawLine(all, times[shown.k], ends, 0, all.height);

    const close = prepareCanvas(near);
    const { context, width } = close;
    const window = range();
    const place = (ms) => ((ms - window[0]) / (window[1] - window[0])) * width;
    context.fillStyle = colour("text");
    context.font = "12px system-ui, sans-serif";
    const rows = [["Proposed", recording.proposals, 18], ["Yours", shown.sheet.kinds, 58]];
    if (recording.others) rows.push([recording.other, recording.others, 98]);
    for (const [name, kinds, top] of rows) {
      drawRow(context, kinds, width, window, top, kinds === recording.others ? 14 : 20);
      context.fillStyle = colour("soft");
      context.fillText(name, 2, top - 6);
    }
    context.strokeStyle = colour("warm");
    context.lineWidth = 2;
    for (const [at] of recording.doubts) {
      const x = place(times[at]);
      context.strokeRect(x - 3, 5, 6, 6);
    }
    const edge = Math.min(shown.last + 1, times.length - 1);
    context.strokeStyle = colour("text");
    context.setLineDash(shown.isMarked ? [] : [3, 3]);
    context.strokeRect(place(times[shown.first]), 55, place(times[edge]) - place(times[shown.first]),
      26);
    context.setLineDash([]);
    drawLine(close, times[shown.k], window, 0, close.height);
  }

  function drawLine({ context, width }, ms, [from, to], top, bottom) {
    context.strokeStyle = colour("text");
    context.lineWidth = 2;
    const x = ((ms - from) / (to - from)) * width;
    context.beginPath();
    context.moveTo(x, top);
    context.lineTo(x, bottom);
    context.stroke();
  }

  function momentAt(event, canvas, [from, to]) {
    const box = canvas.getBoundingClientRect();
    const ms = from + ((event.clientX - box.left) / box.width) * (to - from);
    let best = 0;
    for (let i = 1; i < times.length; i += 1) {
      if (Math.abs(times[i] - ms) < Math.abs(times[best] - ms)) best = i;
    }
    return best;
  }

  // Returns the first moment of a label whose beginning is near the pointer.
  function edgeAt(event) {
    const box = near.getBoundingClientRect();
    const [from, to] = range();
    if (event.clientY - box.top < 54) return null;
    const { kinds } = shown.sheet;
    for (let i = 1; i < times.length; i += 1) {
      if (kinds[i] === kinds[i - 1] || kinds[i] === "-" || kinds[i - 1] === "-") continue;
      const x = box.left + ((times[i] - from) / (to - from)) * box.width;
      if (Math.abs(event.clientX - x) <= GRAB_PX) return i;
    }
    return null;
  }

  whole.addEventListener("pointerdown", (event) => {
    if (shown) go(momentAt(event, whole, [times[0], times[0] + span()]));
  });
  bar.addEventListener("pointerdown", (event) => {
    if (!shown) return;
    const edge = edgeAt(event);
    if (edge !== null) {
      dragged = { edge, window: range(), from: shown.k };
      bar.setPointerCapture(event.pointerId);
    } else {
      go(momentAt(event, near, range()));
    }
  });
  bar.addEventListener("pointermove", (event) => {
    if (!shown) return;
    if (dragged) go(momentAt(event, near, dragged.window));
    else bar.style.cursor = edgeAt(event) === null ? "pointer" : "ew-resize";
  });
  bar.addEventListener("pointercancel", () => {
    if (dragged) go(dragged.from);
    dragged = null;
  });
  bar.addEventListener("pointerup", (event) => {
    if (!dragged) return;
    const { edge, window, from } = dragged;
    dragged = null;
    const to = momentAt(event, near, window);
    go(from); // the picture where the person was, as before
    const { kinds } = shown.sheet;
    if (to < edge) reach(to, edge - 1, Number(kinds[edge]));
    if (to > edge) reach(edge, to - 1, Number(kinds[edge - 1]));
  });

  return {
    begin(told) {
      recording = told;
      times = told.times_ms;
    },
    show(now) {
      shown = now;
      draw();
    },
  };
}
