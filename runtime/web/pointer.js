// The mouse, the wheel and fingers on the canvas.
//
// Events: `tap` (detail: pixel) where a press did not move.

const STILL_PX = 5;
const WHEEL_PER_PIXEL = 0.0016;
const PIXELS_OF_MODE = [1, 24, 400];

export class Pointer extends EventTarget {
  constructor(canvas, pilot) {
    super();
    Object.assign(this, { canvas, pilot });
    /** Pressed pointers: id to pixel. */
    this.down = new Map();
    /** Where the mouse is, or null. */
    this.over = null;
    const on = (type, then, options) => canvas.addEventListener(type, then, options);
    on('pointerdown', (event) => this.press(event));
    on('pointermove', (event) => this.move(event));
    on('pointerup', (event) => this.release(event));
    on('pointercancel', (event) => this.release(event));
    on('pointerleave', () => { this.over = null; });
    on('wheel', (event) => this.wheel(event), { passive: false });
    on('contextmenu', (event) => event.preventDefault());
    on('dblclick', (event) => pilot.zoomBy(this.pixel(event), 0.4));
  }

  pixel(event) {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  press(event) {
    const pixel = this.pixel(event);
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    this.down.set(event.pointerId, pixel);
    this.began = this.down.size === 1 ? pixel : null;
    if (this.down.size === 2) this.pinch();
    else if (event.button !== 0 || event.shiftKey || event.ctrlKey) this.turn(pixel);
    else this.pilot.grab(pixel);
  }

  turn(pixel) {
    this.turning = pixel;
    this.pilot.pivot(pixel);
  }

  move(event) {
    const pixel = this.pixel(event);
    if (event.pointerType !== 'touch') this.over = pixel;
    if (!this.down.has(event.pointerId)) return;
    this.down.set(event.pointerId, pixel);
    if (this.began && Math.hypot(pixel[0] - this.began[0], pixel[1] - this.began[1]) < STILL_PX) return;
    this.began = null;
    if (this.pinched) {
      this.pinching();
    } else if (this.turning) {
      this.pilot.turnBy(pixel[0] - this.turning[0], pixel[1] - this.turning[1]);
      this.turning = pixel;
    } else {
      this.pilot.drag(pixel);
    }
  }

  release(event) {
    if (!this.down.delete(event.pointerId)) return;
    if (event.type === 'pointerup' && this.began && event.button === 0) {
      this.dispatchEvent(new CustomEvent('tap', { detail: this.pixel(event) }));
    }
    this.began = null;
    this.turning = null;
    this.pinched = null;
    this.pilot.drop();
    // The finger that stays drags on.
    const [rest] = this.down.values();
    if (rest) this.pilot.grab(rest);
  }

  /** Middle, distance and direction of two fingers. */
  fingers() {
    const [[ax, ay], [bx, by]] = this.down.values();
    return {
      middle: [(ax + bx) / 2, (ay + by) / 2],
      apart: Math.max(Math.hypot(bx - ax, by - ay), 20),
      angle: Math.atan2(by - ay, bx - ax),
    };
  }

  pinch() {
    this.pinched = this.fingers();
    this.pilot.pivot(this.pinched.middle);
  }

  /** Two fingers: apart zooms, around turns, both up or down tilts. */
  pinching() {
    const [was, now] = [this.pinched, this.fingers()];
    this.pinched = now;
    const around = Math.atan2(Math.sin(now.angle - was.angle), Math.cos(now.angle - was.angle));
    this.pilot.turn((-around * 180) / Math.PI, -(now.middle[1] - was.middle[1]) * 0.2);
    this.pilot.zoomNow(now.middle, was.apart / now.apart);
  }

  wheel(event) {
    event.preventDefault();
    // A pinch on a touchpad comes as a wheel with Ctrl, in small steps.
    const pixels = event.deltaY * (PIXELS_OF_MODE[event.deltaMode] ?? 1) * (event.ctrlKey ? 6 : 1);
    this.pilot.zoomBy(this.pixel(event), Math.exp(pixels * WHEEL_PER_PIXEL));
  }
}
