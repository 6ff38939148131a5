// What this browser remembers for the pages. Where it may not remember, the usual value applies.

export function recall(key, usual) {
  try {
    return localStorage.getItem(key) ?? usual;
  } catch {
    return usual;
  }
}

export function remember(key, value) {
  try {
    localStorage.setItem(key, value);
  } catch {
    // Then the choice ends with the page.
  }
}
