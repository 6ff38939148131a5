// A sheet to print: all movements and their outputs, in large letters.

import { openPage } from "../shared/header.js";
import { element } from "../shared/wire.js";
import { MOVEMENTS, belongs, describe } from "./movements.js";
import { nameOutput } from "./outputs.js";

const HZ = 2; // for the driver's state above the sheet
const find = (id) => document.getElementById(id);
let view = null;
let groups = [];

const page = openPage(HZ, {
  hello: () => page.send({ do: "outputs" }),
  about(message) {
    view = message;
    show();
  },
  outputs(found) {
    groups = found;
    show();
  },
});

function show() {
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
}

function listRows(layer) {
  return Object.entries(MOVEMENTS).flatMap(([movement, [sign, name]]) => {
    const does = layer.bindings.filter((binding) => belongs(binding, movement));
    if (!does.length) return [];
    const inWords = (output) => nameOutput(groups, output);
    return [element("tr", {},
      element("th", { scope: "row", text: `${sign}  ${name}` }),
      element("td", {}, ...does.map((binding) =>
        element("div", { text: describe(binding, inWords) }))))];
  });
}

find("print").addEventListener("click", () => print());
