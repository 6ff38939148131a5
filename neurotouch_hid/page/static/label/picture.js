// The picture of a moment, with the gel's dots, and the contacts, which a person can move.

import { element } from "../shared/wire.js";

const [WIDTH, HEIGHT] = [346, 260];
const STEPS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

export const MIDDLE = [WIDTH / 2, HEIGHT / 2];

function put(button, [x, y]) {
  button.style.left = `${(100 * (x + 0.5)) / WIDTH}%`;
  button.style.top = `${(100 * (y + 0.5)) / HEIGHT}%`;
  button.setAttribute("aria-label",
    `Contact ${button.dataset.index - -1}, ${x.toFixed(0)}, ${y.toFixed(0)} px`);
}

// `part` finds a part of the page. A contact calls `grasp` as a drag of it begins, `move` with the
// moment, its number and its place, in pixels, and `remove` with its number.
export function makePicture(part, { grasp, move, remove }) {
  let moment = null; // what the server says of the moment that is shown
  let held = null; // a contact that is dragged

  const findLabel = () => moment.label ?? moment.proposal;

  function findPlace(event) {
    const box = part("stage").getBoundingClientRect();
    return [((event.clientX - box.left) / box.width) * WIDTH - 0.5,
      ((event.clientY - box.top) / box.height) * HEIGHT - 0.5];
  }

  function showContacts() {
    const label = findLabel();
    const places = label ? label.contacts : [];
    const list = part("contacts");
    while (list.children.length > places.length) list.lastChild.remove();
    while (list.children.length < places.length) list.append(makeContact(list.children.length));
    for (const [i, place] of places.entries()) {
      put(list.children[i], place);
      list.children[i].classList.toggle("proposed", !moment.label);
    }
  }

  function makeContact(index) {
    const button = element("button", { type: "button", text: String(index + 1) });
    button.dataset.index = String(index);
    button.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      grasp();
      button.focus();
      button.setPointerCapture(event.pointerId);
      held = { index, k: moment.k, place: null };
    });
    button.addEventListener("pointermove", (event) => {
      if (!held || held.index !== index) return;
      held.place = findPlace(event);
      put(button, held.place);
    });
    button.addEventListener("pointerup", () => {
      if (held?.place) move(held.k, index, held.place);
      held = null;
    });
    button.addEventListener("pointercancel", () => { held = null; showContacts(); });
    button.addEventListener("keydown", (event) => {
      const step = STEPS[event.key];
      if (!step && event.key !== "Delete") return;
      event.preventDefault();
      event.stopPropagation();
      if (!step) {
        remove(index);
        return;
      }
      const far = event.shiftKey ? 10 : 1;
      const { contacts } = findLabel();
      const [x, y] = contacts[index];
      contacts[index] = [x + far * step[0], y + far * step[1]];
      put(button, contacts[index]);
      move(moment.k, index, contacts[index]);
    });
    return button;
  }

  return {
    findPlace,
    show(told, alt) {
      moment = told;
      const picture = part("picture");
      if (moment.picture) picture.src = moment.picture;
      else picture.removeAttribute("src");
      picture.alt = alt;
      part("dots").replaceChildren(...moment.dots.map(([x, y, seen]) => {
        const dot = document.createElementNS("http://www.w3.org/2000/svg", "circle");
        for (const [key, value] of [["cx", x + 0.5], ["cy", y + 0.5], ["r", 3.6]]) {
          dot.setAttribute(key, String(value));
        }
        if (!seen) dot.setAttribute("class", "guessed");
        return dot;
      }));
      if (!held) showContacts();
    },
  };
}
