// How keys and buttons are pressed: on keyboards of other letters, and by trembling hands.

const TWICE_MS = 500;

// Returns the name of a key, a letter as Latin keyboards have it: others write another one.
export function readKey({ key, code }) {
  if (key.length > 1) return key;
  const isOther = /^\p{L}$/u.test(key) && !/\p{Script=Latin}/u.test(key);
  return (isOther && /^Key[A-Z]$/.test(code) ? code[3] : key).toLowerCase();
}

// Returns a function that is called at each press: whether a trembling hand has pressed twice.
export function watchPresses() {
  let last = -Infinity;
  return () => {
    const isTwice = performance.now() - last < TWICE_MS;
    last = performance.now();
    return isTwice;
  };
}
