// Guides by sound: direction and distance of the ring, in stereo.
//
// A soft tone pulses, quicker the nearer the ring. It sounds from the side of the ring, higher than
// the steady middle tone if the ring is above, lower if it is below. Straight ahead is one clear
// tone in the middle.

const MIDDLE_HZ = 330;
const OCTAVES = 1.6; // for half a right angle up or down
const NOTES = { passed: [523, 659, 784], missed: [294, 262], over: [523, 659, 784, 1047] };

export class Sound {
  constructor() {
    this._context = null;
    this._due = 0;
    this.on = false;
  }

  // Browsers let a page sound only after a key, a click or a touch.
  start() {
    this.on = true;
    this._context ??= new AudioContext();
    this._context.resume();
    if (!this._out) {
      this._out = this._context.createGain();
      this._out.gain.value = 0.25;
      this._out.connect(this._context.destination);
    }
  }

  stop() {
    this.on = false;
    if (this._context) this._context.suspend();
  }

  follow({ right, up, distance, behind }, pace) {
    if (!this.on || this._context.state !== "running") return;
    const now = this._context.currentTime;
    if (now < this._due) return;
    const pan = behind ? Math.sign(right) || 1 : Math.min(Math.max(right / 0.5, -1), 1);
    const straight = !behind && Math.hypot(right, up) < 0.07;
    const pitch = Math.min(Math.max(up, -0.8), 0.8) / (Math.PI / 4);
    this._play(MIDDLE_HZ, 0.05, 0, 0.3); // the middle, to compare with
    this._play(straight ? 2 * MIDDLE_HZ : MIDDLE_HZ * 2 ** (OCTAVES * pitch), straight ? 0.16 : 0.1,
      pan, 0.9, 0.07);
    this._due = now + Math.min(Math.max(distance / (13 * pace * 5), 0.22), 1);
  }

  say(what) {
    if (!this.on || this._context.state !== "running") return;
    NOTES[what].forEach((hz, i) => this._play(hz, 0.16, 0, 0.9, 0.11 * i));
  }

  _play(hz, length, pan, loud, delay = 0) {
    const context = this._context;
    const begin = context.currentTime + delay;
    const tone = context.createOscillator();
    const gain = context.createGain();
    const side = context.createStereoPanner();
    tone.type = "triangle";
    tone.frequency.value = hz;
    side.pan.value = pan;
    gain.gain.setValueAtTime(0, begin);
    gain.gain.linearRampToValueAtTime(loud, begin + 0.012);
    gain.gain.exponentialRampToValueAtTime(0.001, begin + length);
    tone.connect(gain).connect(side).connect(this._out);
    tone.start(begin);
    tone.stop(begin + length + 0.02);
  }
}
