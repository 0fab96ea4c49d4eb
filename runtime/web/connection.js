// The connection to the daemon: runtime/PROTOCOL.md over a WebSocket. It attaches, comes back when
// it was lost, and hands messages and payloads on.
//
// Events: `welcome`, `planet`, `fault` (detail: the message), `away` (detail: {what, rule, remedy,
// again_ms}, where again_ms is null when only the user can help), `payload` (detail: header, bytes).

const VERSION = 1;
const FIRST_WAIT_MS = 400;
const MOST_WAIT_MS = 8000;
/** Silence in which an attempt is given up. */
const ATTEMPT_MS = 6000;

/** The header and the payload of an envelope. */
export function open(envelope) {
  const length = new DataView(envelope).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(envelope, 4, length)));
  return { header, bytes: new Uint8Array(envelope, 4 + length) };
}

export class Connection extends EventTarget {
  constructor(token) {
    super();
    this.token = token;
    this.connected = false;
    this.welcome = null;
    this.waiters = new Map();
    this.picks = 0;
    this.wait_ms = FIRST_WAIT_MS;
    this.last = null;
  }

  /** Attaches, now. */
  attach() {
    clearTimeout(this.timer);
    this.socket?.close();
    const url = new URL('v1/attach', location.href);
    url.protocol = location.protocol === 'https:' ? 'wss:' : 'ws:';
    url.hash = '';
    url.search = this.token ? new URLSearchParams({ token: this.token }) : '';
    const socket = new WebSocket(url);
    this.socket = socket;
    this.last = null;
    socket.binaryType = 'arraybuffer';
    this.timer = setTimeout(() => socket.close(), ATTEMPT_MS);
    socket.onopen = () => this.send({ type: 'hello', version: VERSION, viewer: 'page' });
    socket.onmessage = ({ data }) => this.heard(socket, data);
    socket.onclose = () => this.lost(socket);
  }

  /** Sends a message; what is said to nobody is forgotten. */
  send(message) {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  /**
   * What a pixel of a camera's latest view shows: a place, null in the sky, undefined when nobody
   * answers or a later pick took its place.
   */
  pick(camera, x, y) {
    if (!this.connected) return Promise.resolve(undefined);
    this.waiters.get(camera)?.tell(undefined);
    this.picks += 1;
    const id = this.picks;
    this.send({ type: 'pick', camera, id, x, y });
    return new Promise((tell) => { this.waiters.set(camera, { id, tell }); });
  }

  heard(socket, data) {
    if (socket !== this.socket) return;
    if (data instanceof ArrayBuffer) {
      this.tell('payload', open(data));
      return;
    }
    const message = JSON.parse(data);
    if (message.type === 'welcome') {
      clearTimeout(this.timer);
      this.connected = true;
      this.wait_ms = FIRST_WAIT_MS;
      this.welcome = message;
      this.tell('welcome', message);
    } else if (message.type === 'picked') {
      const waiter = this.waiters.get(message.camera);
      if (waiter?.id === message.id) {
        this.waiters.delete(message.camera);
        waiter.tell(message.place);
      }
    } else if (message.type === 'error') {
      if (message.fatal) this.last = message;
      else this.tell('fault', message);
    } else if (message.type === 'bye') {
      this.last = { code: 'bye', what: message.reason, rule: '', remedy: '' };
    } else if (message.type === 'planet') {
      this.tell('planet', message);
    }
  }

  lost(socket) {
    if (socket !== this.socket) return;
    clearTimeout(this.timer);
    const was = this.connected;
    this.connected = false;
    for (const waiter of this.waiters.values()) waiter.tell(undefined);
    this.waiters.clear();
    const hopeless = ['token', 'version', 'origin'].includes(this.last?.code);
    const again_ms = hopeless ? null : this.wait_ms * (0.8 + 0.4 * Math.random());
    const said = this.last ?? {
      what: was ? 'The connection to the daemon was lost' : 'The daemon does not answer',
      rule: 'This page shows what a running daemon draws',
      remedy: 'Start reliefd serve; the page goes on by itself',
    };
    if (!hopeless) {
      this.timer = setTimeout(() => this.attach(), again_ms);
      this.wait_ms = Math.min(this.wait_ms * 1.7, MOST_WAIT_MS);
    }
    this.tell('away', { ...said, again_ms });
  }

  tell(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }
}
