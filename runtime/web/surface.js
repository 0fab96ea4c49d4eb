// What is drawn over the ground, how exactly the ground is drawn, and what that costs.

import { grouped } from './coordinates.js';
import { $, choices, fill, show } from './elements.js';

const OVERLAYS = [
  ['none', 'None', ''],
  ['wireframe', 'Wireframe', 'The sides of the triangles.'],
  ['lod', 'Detail', 'A colour for each level of the triangles.'],
  ['pages', 'Pages', 'The tile that each pixel’s height comes from.'],
  ['error', 'Error', 'How far the drawn surface is from the true one.'],
];

export class Surface {
  constructor(state, frames) {
    this.state = state;
    this.chosen = choices($('overlay'), OVERLAYS, (overlay) => state.change({ overlay }));
    $('threshold').oninput = () => state.change({ pixel_error: 2 ** Number($('threshold').value) });
    state.addEventListener('change', ({ detail }) => {
      if (detail.has('overlay') || detail.has('pixel_error') || detail.has('planet')) this.show();
    });
    frames.addEventListener('shown', ({ detail }) => this.cost(detail.header));
  }

  show() {
    const { overlay, pixel_error } = this.state;
    this.chosen(overlay);
    $('overlay-said').textContent = OVERLAYS.find(([value]) => value === overlay)[2];
    const pixels = (value) => `${Number(value.toFixed(value < 4 ? 2 : 1))} px`;
    show($('legend'), overlay === 'error');
    $('legend-middle').textContent = pixels(pixel_error);
    $('legend-end').textContent = pixels(2 * pixel_error);
    $('threshold').value = Math.log2(pixel_error);
    $('threshold-said').textContent = pixels(pixel_error);
    fill($('threshold'));
  }

  /** Figures of a picture. */
  cost({ stats, complete }) {
    $('triangles').textContent = grouped(stats.triangles) + (stats.holes ? ' (too many)' : '');
    $('milliseconds').textContent = `${stats.draw_ms.toFixed(stats.draw_ms < 10 ? 1 : 0)} ms`;
    $('tiles').textContent = complete
      ? grouped(stats.tiles_resident)
      : `${grouped(stats.tiles_resident)} + ${grouped(stats.tiles_missing)}`;
  }
}
