// Lets a phone in, and shows its link as a square to scan.

// Returns the function that shows a link, or without one that no phone is connected.
export function makeRemote(find, say, ask) {
  const PLACE = "remote-state";
  find("remote").addEventListener("click", () => {
    ask({ do: "remote" }, PLACE);
    say(PLACE, "One moment …");
  });
  find("remote-end").addEventListener("click", () => ask({ do: "stop", what: "remote" }, PLACE));

  return function show(found) {
    find("remote").hidden = Boolean(found);
    find("remote-end").hidden = !found;
    find("code").hidden = !found;
    if (found) find("code").src = found.code;
    say(PLACE, found ? `Scan this with the phone's camera. The access ends after ${found.minutes} minutes. ` +
      "What was started from the phone ends then, too."
      : "No phone is connected.");
    say("remote-link", found ? found.link : "");
  };
}
