// The keyboard: held keys move the camera evenly, others act once.

const HELD = {
  ArrowUp: 'ahead', KeyW: 'ahead', ArrowDown: 'back', KeyS: 'back',
  ArrowLeft: 'left', KeyA: 'left', ArrowRight: 'right', KeyD: 'right',
  KeyQ: 'turnLeft', KeyE: 'turnRight', KeyR: 'lookUp', KeyF: 'lookDown',
};
/** By the character, wherever the layout has it. */
const NAMED = { '+': 'nearer', '=': 'nearer', '-': 'farther', _: 'farther' };
const DEG_PER_S = 40;

export class Keys {
  /** `actions`: what keys that are not held do, by lower-case character. */
  constructor(pilot, actions) {
    Object.assign(this, { pilot, actions });
    this.held = new Map();
    window.addEventListener('keydown', (event) => this.press(event));
    window.addEventListener('keyup', (event) => this.held.delete(event.code));
    window.addEventListener('blur', () => this.held.clear());
  }

  press(event) {
    const on = (selector) => event.target.closest?.(selector);
    const typing = on('input, select, textarea') && event.key !== 'Escape';
    const pressing = on('button, [tabindex]:not(canvas)') && [' ', 'Enter'].includes(event.key);
    if (event.ctrlKey || event.metaKey || event.altKey || typing || pressing || document.querySelector('dialog[open]')) return;
    const understood = on('[role=radiogroup]') && event.key.startsWith('Arrow');
    const motion = NAMED[event.key] ?? HELD[event.code];
    const action = this.actions[event.key.toLowerCase()];
    if (understood || (!motion && !action)) return;
    event.preventDefault();
    if (action) {
      if (!event.repeat) action();
      return;
    }
    if (!this.held.has(event.code)) {
      this.pilot.stop();
      this.held.set(event.code, motion);
      // A tap is seen even where no picture comes between.
      this.move(1 / 30);
    }
  }

  tick(seconds) {
    if (this.held.size > 0) this.move(Math.min(seconds, 0.1));
  }

  move(seconds) {
    const on = new Set(this.held.values());
    const both = (plus, minus) => Number(on.has(plus)) - Number(on.has(minus));
    const [right, ahead] = [both('right', 'left'), both('ahead', 'back')];
    if (right || ahead) this.pilot.go(right * seconds * 0.7, ahead * seconds * 0.7);
    const [turn, look] = [both('turnRight', 'turnLeft'), both('lookUp', 'lookDown')];
    if (turn || look) this.pilot.lookBy(turn * DEG_PER_S * seconds, look * DEG_PER_S * seconds);
    const nearer = both('nearer', 'farther');
    if (nearer) this.pilot.zoomNow(this.pilot.centre, Math.exp(-1.4 * nearer * seconds));
  }
}
