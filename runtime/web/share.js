// What leaves the page: a PNG of the view, and the view in the address.

import { $ } from './elements.js';
import { Frames } from './frames.js';
import { Resolution } from './resolution.js';

const PAUSE_MS = 400;
const PATIENCE_MS = 30_000;

export class Share {
  constructor(state, connection, pilot, notices) {
    Object.assign(this, { state, connection, pilot, notices, written_ms: 0, saving: false });
    $('save').onclick = () => this.save();
    $('link').onclick = () => this.copy();
  }

  /** Keeps the address up to date, a few times a second at most: browsers refuse more. */
  tick() {
    const now = performance.now();
    if (now - this.written_ms < PAUSE_MS) return;
    this.written_ms = now;
    const bookmark = `#${this.state.bookmark()}`;
    if (bookmark !== location.hash) history.replaceState(null, '', bookmark);
  }

  /** Copies the address of the view; a token is the user's own and stays here. */
  async copy() {
    const url = new URL(location.href);
    const secret = url.searchParams.has('token');
    url.searchParams.delete('token');
    url.hash = this.state.bookmark();
    try {
      await navigator.clipboard.writeText(url.href);
      this.notices.say({ what: secret ? 'Link copied, without your token' : 'Link copied', mild: true });
    } catch {
      this.notices.say({
        what: 'The link could not be copied',
        rule: 'The browser lets only pages from https or from this machine write to the clipboard',
        remedy: 'Copy the address of this page: it holds the view',
      });
    }
  }

  /** Asks for the view as a PNG in all pixels of the screen, and hands it to the browser. */
  async save() {
    if (this.saving || !this.connection.connected) return;
    this.saving = true;
    $('save').setAttribute('aria-busy', true);
    const frames = new Frames(this.connection, 'still', document.createElement('canvas'), { format: 'png' });
    try {
      const { width, height } = this.pilot.lens;
      const size = new Resolution().size(width, height, this.connection.welcome.limits.pixels, false);
      frames.attach(this.state.planet);
      const bytes = await this.whole(frames, { ...this.state.view(), size });
      const link = document.createElement('a');
      link.href = URL.createObjectURL(new Blob([bytes], { type: 'image/png' }));
      link.download = `relief-${this.state.planet.name}.png`;
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
    } catch (error) {
      this.notices.say({ what: 'The picture could not be saved', rule: error.message, remedy: 'Try again' });
    } finally {
      frames.detach();
      this.saving = false;
      $('save').setAttribute('aria-busy', false);
    }
  }

  /** The bytes of a view's picture once nothing is missing. */
  whole(frames, view) {
    return new Promise((done, failed) => {
      const late = () => failed(new Error('No whole picture came within half a minute'));
      const timer = setTimeout(late, PATIENCE_MS);
      const end = (then, value) => {
        clearTimeout(timer);
        then(value);
      };
      frames.addEventListener('shown', ({ detail }) => {
        if (detail.header.complete) end(done, detail.bytes);
      });
      this.connection.addEventListener('away', () => end(failed, new Error('The daemon went away')), { once: true });
      this.connection.addEventListener('fault', ({ detail }) => {
        if (detail.camera === 'still') end(failed, new Error(`${detail.what}: ${detail.rule}`));
      });
      frames.request(view);
    });
  }
}
