// Lines and marks over the picture.

import { project, stand } from './camera.js';

const INK = '#ffd166';
const SHADE = 'rgba(6, 12, 22, .75)';

export class Marks {
  constructor(canvas, state, frames) {
    Object.assign(this, { canvas, state, frames });
    this.measure = null;
    this.pose = null;
  }

  /** Pixels of places, null where they are hidden. */
  pixels(places) {
    const { body } = this.state;
    const { lens } = this.frames.shown.note;
    const camera = stand(body, this.pose);
    return places.map((place) => {
      const point = body.point(place);
      return body.sees(camera.at, point) ? project(camera, lens, point) : null;
    });
  }

  /** Draws all marks as a pose's camera sees them; without one, as before. */
  draw(pose = this.pose) {
    const { canvas } = this;
    this.pose = pose;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== Math.floor(width * ratio) || canvas.height !== Math.floor(height * ratio)) {
      [canvas.width, canvas.height] = [Math.floor(width * ratio), Math.floor(height * ratio)];
    }
    const ink = canvas.getContext('2d');
    ink.setTransform(ratio, 0, 0, ratio, 0, 0);
    ink.clearRect(0, 0, width, height);
    const shown = this.frames.shown;
    if (!shown || !pose || shown.note.planet !== this.state.planet.name) return;
    ink.lineCap = 'round';
    ink.lineJoin = 'round';
    if (this.measure?.line.length) this.path(ink, this.pixels(this.measure.line));
    const ends = this.measure?.ends.map(({ place, height_m }) => [...place, height_m]) ?? [];
    for (const pixel of this.pixels(ends)) if (pixel) this.dot(ink, pixel);
  }

  path(ink, pixels) {
    for (const [style, width] of [[SHADE, 5], [INK, 2.5]]) {
      Object.assign(ink, { strokeStyle: style, lineWidth: width });
      ink.beginPath();
      let pen = false;
      for (const pixel of pixels) {
        if (pixel && pen) ink.lineTo(...pixel);
        else if (pixel) ink.moveTo(...pixel);
        pen = pixel !== null;
      }
      ink.stroke();
    }
  }

  dot(ink, [x, y]) {
    for (const [style, radius] of [[SHADE, 7], [INK, 5], ['#10243d', 2]]) {
      ink.fillStyle = style;
      ink.beginPath();
      ink.arc(x, y, radius, 0, 2 * Math.PI);
      ink.fill();
    }
  }
}
