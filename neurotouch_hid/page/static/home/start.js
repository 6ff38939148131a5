// What plays, and what can be started: from any state to playing, without a terminal.

const PICTURE_MS = 1000;
const FAULT = /^(Error|Fix|Warning|No real)/;
const STARTING = "The first start on a machine takes up to a minute.";
const ADVICE = { // where the page can do nothing
  no_camera: "Plug the camera in, or try everything with the mouse first.",
  no_right: "You may not use the camera yet. Once, in a terminal: neurotouch setup",
  no_pad: "No game sees what you do yet. Once, in a terminal: neurotouch setup",
  service_stopped: "An administrator starts it: sudo systemctl start neurotouch",
  unusable: "See below: Check this machine.",
  no_data: "Look at its cable, or try everything with the mouse first.",
  ready: "Keep your hand off the gel until the dots are found.",
};
const STARTS = { camera: "camera", events: "camera", webcam: "webcam" };
const MENDS = { setup: "Give me the right", service: "Start the service" };
const LOOKING = "Looking …";
const WEBCAM = "If it looks at a gel, start with it. If not, try everything with the mouse first.";
const PASSWORD = "This computer then asks for the password of an administrator.";
const PLACE = "start-lines"; // of what a request has led to

// `ask(request, place)` asks for something. `lose()` is called when the present states are over, and
// `changed()` when something else is to be shown.
export function makeStart(find, { page, ask, say, lose, changed }) {
  let state = null; // of the driver
  let situation = null;
  let plugged = ""; // a camera that could play in place of a simulated gel
  let runs = false;
  let starting = "";
  let isLost = false; // there is no connection, so nothing is known
  let replaces = false; // a camera's driver takes the place of one with a simulated gel
  let begun = false; // this page started the driver
  let ended = false; // this page ends it
  let faults = []; // errors of a failed start
  let looks = 0;

  // Announced once: a screen reader would read a live region again whenever a dialog closes.
  function sayResult(text) {
    if (find(PLACE).textContent !== text) page.tell(text);
    say(PLACE, text);
  }

  function describe(isMouse) {
    if (isLost) return ["Not connected.", ""];
    if (starting) return ["Starting …", ""];
    if (state && !state.gel.found) { // the header has the reason
      return [`The gel is ${state.gel.text.split(":")[0]}.`, state.gel.fix];
    }
    if (isMouse) {
      return ["The mouse presses a simulated gel.", "Drag on the gel below, turn the " +
        "wheel, or use the arrow keys, Q, E, plus and minus."];
    }
    if (state && state.slow.simulated) {
      return ["A simulated hand plays.", "You can try everything on this page with it."];
    }
    if (state) return ["Ready to play.", `Every game sees the gamepad: ${state.slow.device}.`];
    if (!situation) return [LOOKING, ""];
    const isReady = situation.kind === "ready" && situation.start === "camera";
    return [isReady ? "The camera is ready." : situation.text,
      situation.mend ? PASSWORD : situation.start === "webcam" ? WEBCAM : ADVICE[situation.kind]];
  }

  function show(newest, isMouse) {
    state = newest;
    const [words, advice] = describe(isMouse);
    const before = find("situation").textContent;
    const isNews = before !== words && !isLost; // that the connection is lost, the header says
    if (isNews && state) page.say(words);
    else if (isNews && situation && !starting && before !== LOOKING) page.tell(words);
    say("situation", words);
    say("advice", advice);
    const isIdle = !state && !starting && situation !== null;
    const startable = isIdle ? situation.start : state && state.slow.simulated ? plugged : "";
    const hadFocus = document.activeElement === find("start-camera");
    find("start-camera").hidden = !startable;
    if (startable) {
      say("start-camera", isIdle ? `Start with the ${STARTS[startable]}`
        : `Play with the ${STARTS[startable]} instead`);
      find("start-camera").dataset.what = startable;
    }
    find("mend").hidden = !(isIdle && situation.mend);
    if (isIdle && situation.mend) say("mend", MENDS[situation.mend]);
    find("start-mouse").hidden = !isIdle;
    if (hadFocus && !startable && isIdle) find("start-mouse").focus(); // the camera was unplugged
    find("fly").hidden = !state;
    find("press").hidden = !isMouse;
    find("look").hidden = !state;
    find("end").hidden = !runs;
    // The button that started it is gone, and the focus too.
    if (state && begun && document.activeElement === document.body) find("fly").focus();
    if (state) begun = false;
    if (ended && isIdle) {
      const next = ["start-camera", "mend", "start-mouse"].map(find).find((each) => !each.hidden);
      if (next && document.activeElement === document.body) next.focus();
      ended = false;
    }
  }

  function start(what) {
    replaces = state !== null;
    [starting, begun, faults] = [what, true, []];
    ask({ do: "start", what, ...(replaces ? { instead: true } : {}) }, PLACE);
    lose();
    sayResult(STARTING);
    changed();
  }

  find("start-camera").addEventListener("click", () => start(find("start-camera").dataset.what));
  find("start-mouse").addEventListener("click", () => start("mouse"));
  find("mend").addEventListener("click", () => {
    faults = [];
    ask({ do: "start", what: situation.mend }, PLACE);
    sayResult("Asking for the password …");
  });
  find("end").addEventListener("click", () => {
    [faults, ended] = [[], true]; // what its start said is over
    ask({ do: "stop", what: "driver" }, PLACE);
  });
  find("look").addEventListener("click", () => {
    clearInterval(looks);
    looks = looks ? 0 : setInterval(() => page.send({ do: "picture" }), PICTURE_MS);
    if (looks) page.send({ do: "picture" });
    find("picture").hidden = true;
    find("look").textContent = looks ? "Hide the picture" : "Show the camera's picture";
  });

  return {
    show,
    get isLost() { return isLost; },
    setLost(is) { isLost = is; },
    setRuns(is) {
      [isLost, runs, replaces] = [false, is, is && replaces];
    },
    setSituation(found) { situation = found; },
    setPlugged(found) {
      plugged = found;
      if (plugged) page.tell(`A ${STARTS[plugged]} is plugged in.`);
    },
    // A state has come. Returns false for the last ones of a driver that ends.
    meet() {
      isLost = false;
      if (replaces) return false;
      if (starting) sayResult(faults.join(" "));
      [runs, starting] = [true, ""];
      return true;
    },
    // Takes news of the program that was started.
    hear(news) {
      if ("line" in news) {
        if (FAULT.test(news.line)) faults.push(news.line);
        if (faults.length) sayResult(faults.join(" "));
        return;
      }
      if (news.name in MENDS && news.code && !faults.length) faults = ["Nothing was changed."];
      starting = "";
      sayResult(faults.join(" "));
      changed();
    },
    refuse(sentence) {
      [starting, replaces] = ["", false];
      sayResult(sentence);
    },
  };
}
