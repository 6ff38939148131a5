// The names that profiles have for keys, by place: what a key writes is the desktop's matter.

export const KEYS = {
  Space: "space", Enter: "enter", Escape: "escape", Tab: "tab", Backspace: "backspace",
  Delete: "delete", Insert: "insert", Home: "home", End: "end", PageUp: "page_up",
  PageDown: "page_down", ArrowUp: "up", ArrowDown: "down", ArrowLeft: "left", ArrowRight: "right",
  Minus: "minus", Equal: "equal", BracketLeft: "left_bracket", BracketRight: "right_bracket",
  Semicolon: "semicolon", Quote: "apostrophe", Backquote: "grave", Backslash: "backslash",
  Comma: "comma", Period: "dot", Slash: "slash", CapsLock: "caps_lock", NumLock: "num_lock",
  ScrollLock: "scroll_lock", PrintScreen: "print", Pause: "pause", ContextMenu: "menu",
  NumpadAdd: "keypad_plus", NumpadSubtract: "keypad_minus", NumpadMultiply: "keypad_times",
  NumpadDivide: "keypad_divide", NumpadDecimal: "keypad_dot", NumpadEnter: "keypad_enter",
  MediaPlayPause: "play", MediaStop: "stop", MediaTrackNext: "next", MediaTrackPrevious: "previous",
  AudioVolumeMute: "mute", AudioVolumeUp: "volume_up", AudioVolumeDown: "volume_down",
  BrowserBack: "back", BrowserForward: "forward", BrowserRefresh: "refresh",
  BrowserHome: "home_page", BrowserSearch: "search",
};

// The name of a key; empty where profiles have none.
export function nameKey(code) {
  const plain = /^(?:Key([A-Z])|Digit(\d)|(F\d{1,2}))$/.exec(code);
  if (plain) return plain.slice(1).find(Boolean).toLowerCase();
  const keypad = /^Numpad(\d)$/.exec(code);
  return keypad ? `keypad_${keypad[1]}` : KEYS[code] || "";
}
