// What the doctor finds, and its commands to copy.

import { element } from "../shared/wire.js";

const COPIED_MS = 3000;

export function makeCheck(find, say) {
  let lines = [];

  function begin() {
    lines = [];
    find("findings").replaceChildren();
    say("check-state", "Checking. This takes some seconds, the first time a minute.");
  }

  function hear(news) {
    if ("line" in news) {
      lines.push(news.line);
      return;
    }
    const text = lines.join("\n");
    let findings = [];
    try {
      findings = JSON.parse(text.slice(text.indexOf("\n[") + 1));
    } catch {
      say("check-state", lines.at(-1) || "The check has ended without a result.");
      return;
    }
    show(findings);
  }

  function show(findings) {
    const failed = findings.filter(({ status }) => status === "FAILED").length;
    say("check-state", failed ? `${failed} of ${findings.length} checks found a fault.`
      : `${findings.length} checks: everything is in order.`);
    find("findings").replaceChildren(...findings
      .filter(({ status }) => status !== "OK" && status !== "SKIPPED")
      .map(({ status, check, sentence, fix, commands }) => element("li", {},
        element("strong", { text: `${status} ${check}: ` }), sentence,
        ...(fix ? [element("p", { class: "aside", text: `Fix: ${fix}` })] : []),
        ...(commands.length ? showCommands(check, commands.join("\n")) : []))));
  }

  function showCommands(check, commands) {
    const shown = [element("pre", { tabindex: "0", "aria-label": `Commands for ${check}`,
      role: "region", text: commands })];
    if (!navigator.clipboard) return shown; // on a phone: the page comes unencrypted
    const copy = element("button", { type: "button", text: "Copy",
      "aria-label": `Copy the commands for ${check}` });
    copy.addEventListener("click", async () => {
      await navigator.clipboard.writeText(commands);
      copy.textContent = "Copied";
      say("check-state", "Copied. Paste it into a terminal.");
      setTimeout(() => { copy.textContent = "Copy"; }, COPIED_MS);
    });
    return [...shown, copy];
  }

  return { begin, hear };
}
