// Questions to the daemon over HTTP: heights and distances.

export class Questions {
  constructor(token) {
    this.token = token;
  }

  /**
   * Asks with the fields as a query and a body to be posted, if there is one. Throws an error with
   * what, rule and remedy as its message.
   */
  async ask(planet, question, fields, body) {
    const url = new URL(`v1/planets/${encodeURIComponent(planet.name)}/${question}`, location.href);
    url.hash = '';
    url.search = new URLSearchParams({ ...fields, ...(this.token && { token: this.token }) });
    const post = { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify(body) };
    const answer = await fetch(url, body && post);
    const said = await answer.json().catch(() => ({}));
    if (answer.ok) return said;
    const { what, rule, remedy } = said;
    throw new Error([what ?? `the daemon answered ${answer.status}`, rule, remedy].filter(Boolean).join('; '));
  }

  /** Height of the relief, metres. */
  async height(planet, [x, y]) {
    const point = planet.plane ? { x, y } : { lon: x, lat: y };
    const { height_m } = await this.ask(planet, 'height', point);
    return height_m;
  }

  /** Heights of the relief at many places, metres. */
  async heights(planet, points) {
    const { heights_m } = await this.ask(planet, 'heights', {}, { points });
    return heights_m;
  }

  /** {distance_m, azimuth_from_deg, azimuth_to_deg} along the geodesic. */
  distance(planet, from, to) {
    return this.ask(planet, 'distance', { from: from.join(','), to: to.join(',') });
  }
}
