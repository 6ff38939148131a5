// A sheet to print: all movements and their outputs, and the ways to stop, in large letters.

import { openPage } from "../shared/header.js";
import { element } from "../shared/wire.js";
import { MOVEMENTS, belongs, describe, stops } from "./movements.js";
import { nameOutput } from "./outputs.js";

const HZ = 2; // for the driver's state above the sheet
const find = (id) => document.getElementById(id);
// The link names the profile that is chosen in the list; without a name it is the active one.
const [, chosen] = /[#&]profile=([\w-]+)/.exec(location.hash) || [];
let view = null;
let groups = [];

const page = openPage(HZ, {
  hello() {
    for (const what of ["outputs", "stop keys"]) page.send({ do: what });
    if (chosen) page.send({ do: "profile", profile: chosen });
  },
  about(message) {
    if (chosen) return;
    view = message;
    show();
  },
  shown(message) {
    view = message;
    show();
  },
  stop_keys({ pause, panic }) {
    find("stop-keys").hidden = false;
    find("pause-keys").textContent = pause;
    find("panic-keys").textContent = panic;
  },
  outputs(found) {
    groups = found;
    show();
  },
});

function show() {
  find("stops").replaceChildren();
  if (!view && chosen) return; // its answer comes
  if (!view || !view.layers) {
    find("about").textContent = view ? view.fault : "There is no profile to show.";
    find("layers").replaceChildren();
    return;
  }
  find("title").textContent = `What each movement does: ${view.profile}`;
  find("about").textContent = view.description;
  find("layers").replaceChildren(...view.layers.flatMap((layer) => [
    ...(view.layers.length > 1 ? [element("h2", { text: `Layer ${layer.name}` })] : []),
    element("table", {}, element("tbody", {}, ...listRows(layer))),
  ]));
  find("stops").replaceChildren(...view.stops.map(({ when, does }) => element("tr", {},
    element("th", { scope: "row", text: `The gel: ${when}` }), element("td", { text: does }))));
}

function listRows(layer) {
  return Object.entries(MOVEMENTS).flatMap(([movement, [sign, name]]) => {
    const does = layer.bindings.filter((binding) => belongs(binding, movement));
    if (!does.length) return [];
    const inWords = (output) => nameOutput(groups, output);
    const stopping = view.stops.filter((each) => stops(each, movement));
    return [element("tr", {},
      element("th", { scope: "row", text: `${sign}  ${name}` }),
      element("td", {}, ...does.map((binding) =>
        element("div", { text: describe(binding, inWords) })),
      ...stopping.map(({ when, does: what }) =>
        element("div", { class: "stop", text: `${when}: ${what}` }))))];
  });
}

find("print").addEventListener("click", () => print());
