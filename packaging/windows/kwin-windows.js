// Runs in KWin (Plasma 5 and 6) while a driver of neurotouch runs, which puts the line
// 'const LISTENER = "its address on the session bus"' before this. Titles are not read.
"use strict";

function tell(window) {
    callDBus(
        LISTENER, "/", "io.github.neurotouch_hid.Windows", "Activated",
        window ? String(window.resourceClass || "") : "",
        window ? String(window.resourceName || "") : "",
        window ? String(window.desktopFileName || "") : ""
    );
}

// Plasma 6 calls clients windows.
(workspace.windowActivated || workspace.clientActivated).connect(tell);
tell("activeWindow" in workspace ? workspace.activeWindow : workspace.activeClient);
