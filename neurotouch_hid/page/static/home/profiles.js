// The list of profiles: which one plays, and which other one a person only looks at.

import { showOptions } from "../shared/wire.js";

const NOTHING = { layers: [], stops: [] }; // until the answer comes

// `look(name)` asks for a profile, `changed()` is called when another one is to be shown.
export function makeProfiles(find, { say, look, changed }) {
  const select = find("profile-choice");
  let rows = [];
  let chosen = ""; // in the list, and not played
  let plays = ""; // in the driver; empty while none runs
  let view = null; // of the chosen one

  const findActive = () => plays || (rows.find(({ first }) => first) || {}).name || "";

  function show(found) {
    rows = found;
    showOptions(select, rows.map(({ name, own }) => [name, own ? `${name} (yours)` : name]));
    tell();
  }

  function setPlayed(name) {
    if (name === plays) return;
    plays = name;
    tell();
  }

  function choose(name) {
    chosen = name;
    view = null;
    tell();
    if (chosen) look(chosen);
    changed();
  }

  function tell() {
    const active = findActive();
    const names = rows.map(({ name }) => name);
    if (chosen && (chosen === active || !names.includes(chosen))) {
      [chosen, view] = ["", null];
      changed(); // the cards are those of the one that plays again
    }
    select.value = chosen || (names.includes(active) ? active : names[0] || "");
    const row = rows.find(({ name }) => name === select.value);
    say("profile-about", row ? row.about : "");
    const now = plays ? `${active} plays now.` : `The next start plays ${active}.`;
    say("plays", !active ? "" : chosen && !(row && row.broken)
      ? `Below is what ${chosen} does, to look at. ${now} 'Play with it' changes that.` : now);
    const sheet = find("sheet");
    sheet.hash = sheet.hash.replace(/(&profile=[\w-]*)?$/, select.value ? `&profile=${select.value}` : "");
  }

  select.addEventListener("change", () => choose(select.value));

  return {
    show, setPlayed,
    get name() { return select.value; },
    forget: () => choose(""), // a copy plays instead
    shown(found, name) {
      if (name !== chosen) return;
      view = found;
      changed();
    },
    // The profile that is only looked at; null while it is the one that plays.
    get view() { return chosen ? view || NOTHING : null; },
  };
}
