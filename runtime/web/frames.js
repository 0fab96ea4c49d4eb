// A camera of the connection and the canvas that shows it: one view on its way at a time, the latest
// wins, and each picture is acknowledged once it can be drawn.
//
// Events: `shown`: the canvas has a new picture (detail: {view, header, pose, fov_deg}).

/** After so long without a picture a view is sent again. */
const PATIENCE_MS = 4000;

export class Frames extends EventTarget {
  constructor(connection, name, canvas, { format = 'jpeg', quality = 88 } = {}) {
    super();
    this.connection = connection;
    this.name = name;
    this.canvas = canvas;
    this.frame = { format, ...(format === 'jpeg' && { quality }) };
    this.number = 0;
    this.sent = new Map();
    this.outstanding = null;
    this.next = null;
    this.shown = null;
    this.payload = ({ detail }) => this.arrived(detail);
    this.fault = ({ detail }) => this.refused(detail);
    connection.addEventListener('payload', this.payload);
    connection.addEventListener('fault', this.fault);
  }

  /** Makes the camera, on a new connection too. */
  attach(planet) {
    this.outstanding = null;
    this.sent.clear();
    this.connection.send({ type: 'camera', camera: this.name, planet: planet.name, streams: { frame: this.frame } });
  }

  /** Ends the camera. */
  detach() {
    this.connection.send({ type: 'detach', camera: this.name });
    this.connection.removeEventListener('payload', this.payload);
    this.connection.removeEventListener('fault', this.fault);
  }

  /** Asks for a view, now or when the one on its way is there. `note` comes back with its picture. */
  request(view, note = {}) {
    this.next = { view, note };
    const waited_ms = this.outstanding ? performance.now() - this.outstanding.sent_ms : Infinity;
    if (waited_ms > PATIENCE_MS) this.send();
  }

  /** The latest view that was sent: what a pick is about. */
  get latest() {
    return this.sent.get(this.number) ?? null;
  }

  send() {
    if (!this.next || !this.connection.connected) return;
    const { view, note } = this.next;
    this.next = null;
    this.number += 1;
    this.outstanding = { number: this.number, view, note, sent_ms: performance.now() };
    this.sent.set(this.number, this.outstanding);
    this.connection.send({ type: 'view', camera: this.name, view: this.number, ...view });
  }

  async arrived({ header, bytes }) {
    if (header.camera !== this.name || header.stream !== 'frame') return;
    const asked = this.sent.get(header.view);
    let picture = null;
    try {
      picture = await createImageBitmap(new Blob([bytes], { type: `image/${header.format}` }));
    } finally {
      this.connection.send({ type: 'ack', camera: this.name, seq: header.seq });
    }
    if (this.outstanding && header.view >= this.outstanding.number) {
      this.answered(performance.now() - this.outstanding.sent_ms);
    }
    // Older than what is shown: two may be decoded at a time.
    if (!asked || header.view < (this.shown?.header.view ?? 0)) return;
    for (const number of this.sent.keys()) if (number < header.view) this.sent.delete(number);
    this.shown = { ...asked, header, bytes };
    this.draw(picture);
    this.dispatchEvent(new CustomEvent('shown', { detail: this.shown }));
  }

  answered(trip_ms) {
    this.trip_ms = trip_ms;
    const { note } = this.outstanding;
    this.outstanding = null;
    note.took?.(trip_ms);
    this.send();
  }

  refused(fault) {
    if (fault.camera === this.name && fault.view === this.outstanding?.number) {
      this.outstanding = null;
      this.send();
    }
  }

  draw(picture) {
    const { canvas } = this;
    if (canvas.width !== picture.width || canvas.height !== picture.height) {
      [canvas.width, canvas.height] = [picture.width, picture.height];
    }
    this.picture?.close();
    this.picture = picture;
    this.paint();
  }

  /** Paints the last picture, its pixels moved by an affine map. */
  paint(map = [1, 0, 0, 1, 0, 0]) {
    const ink = this.canvas.getContext('2d', { alpha: false });
    ink.setTransform(1, 0, 0, 1, 0, 0);
    ink.clearRect(0, 0, this.canvas.width, this.canvas.height);
    ink.setTransform(...map);
    ink.drawImage(this.picture, 0, 0);
    ink.setTransform(1, 0, 0, 1, 0, 0);
  }
}
