// The page: puts its parts together and runs the loop that asks for pictures.

import { Connection } from './connection.js';
import { $, show } from './elements.js';
import { Frames } from './frames.js';
import { Ground } from './ground.js';
import { Inset } from './inset.js';
import { Instruments } from './instruments.js';
import { Keys } from './keys.js';
import { Marks } from './marks.js';
import { Measure } from './measure.js';
import { Notices } from './notices.js';
import { Pilot } from './pilot.js';
import { Pointer } from './pointer.js';
import { Questions } from './questions.js';
import { Readout } from './readout.js';
import { Resolution } from './resolution.js';
import { Search } from './search.js';
import { Share } from './share.js';
import { ViewState } from './state.js';
import { Sun } from './sun.js';
import { Surface } from './surface.js';
import { Warp } from './warp.js';

/** Without motion for so long the picture is asked for in all pixels. */
const STILL_MS = 180;
const ZOOM_STEP = 2;
const NARROW = window.matchMedia('(max-width: 720px)');

const token = new URLSearchParams(location.search).get('token');
const canvas = $('view');
const state = new ViewState();
const connection = new Connection(token);
const questions = new Questions(token);
const notices = new Notices(() => connection.attach());
const frames = new Frames(connection, 'main', canvas);
const resolution = new Resolution();
const ground = new Ground(state, questions);
const pilot = new Pilot(state, canvas, ground);
const pointer = new Pointer(canvas, pilot);
const readout = new Readout(state, frames, pointer, pilot);
const marks = new Marks($('marks'), state, frames);
const measure = new Measure(state, readout, questions, () => marks.draw());
const sun = new Sun(state, notices);
const surface = new Surface(state, frames);
const instruments = new Instruments(state, pilot);
const search = new Search(state, pilot, questions);
const inset = new Inset(state, connection, pilot);
const share = new Share(state, connection, pilot, notices);
const warp = new Warp(state, frames, pilot, marks);
marks.measure = measure;

function togglePanel(open = $('panel').hidden) {
  show($('panel'), open);
  $('panel-toggle').setAttribute('aria-expanded', open);
  document.body.classList.toggle('panelled', open);
}

const keys = new Keys(pilot, {
  n: () => pilot.north(),
  h: () => pilot.home(),
  g: () => $('place').focus(),
  l: () => togglePanel(),
  m: () => measure.open(!measure.active),
  i: () => inset.open(!inset.frames),
  p: () => share.save(),
  c: () => share.copy(),
  ' ': () => sun.play(!sun.playing),
  '?': () => $('help').showModal(),
  escape: () => measure.open(false),
});

$('zoom-in').onclick = () => pilot.zoomBy(pilot.centre, 1 / ZOOM_STEP);
$('zoom-out').onclick = () => pilot.zoomBy(pilot.centre, ZOOM_STEP);
$('home').onclick = () => pilot.home();
$('help-open').onclick = () => $('help').showModal();
$('panel-toggle').onclick = () => togglePanel();
$('planet').onchange = () => visit($('planet').value);
pointer.addEventListener('tap', ({ detail }) => measure.tap(detail));
NARROW.addEventListener('change', () => togglePanel(!NARROW.matches));
togglePanel(!NARROW.matches);

/** A picture must be asked for. */
let stale = true;
/** The size of the last one was for motion. */
let coarse = false;
state.addEventListener('change', () => { stale = true; });
new ResizeObserver(() => { stale = true; }).observe(canvas);

/** Goes to a planet of the welcome. */
function visit(name) {
  const planet = connection.welcome.planets.find((one) => one.name === name) ?? connection.welcome.planets[0];
  pilot.stop();
  ground.forget();
  state.visit(planet);
  frames.attach(planet);
  stale = true;
}

const bookmarked = () => new URLSearchParams(location.hash.slice(1)).get('planet');

window.addEventListener('hashchange', () => {
  if (!state.planet) return;
  const name = bookmarked();
  if (name && name !== state.planet.name) visit(name);
  if (!name || name === state.planet.name) state.restore(location.hash);
  $('planet').value = state.planet.name;
});

connection.addEventListener('welcome', ({ detail: { planets } }) => {
  notices.back();
  $('planet').replaceChildren(...planets.map(({ name }) => new Option(name)));
  show($('planet'), planets.length > 1);
  const here = planets.find(({ name }) => name === (state.planet?.name ?? bookmarked()));
  if (state.planet && here?.plane === state.planet.plane) {
    // The daemon is back: the same view goes on.
    state.renew(here);
    frames.attach(here);
    inset.attach();
  } else {
    const { hash } = location;
    const meant = [null, here?.name].includes(bookmarked());
    visit(here?.name);
    if (meant) state.restore(hash);
  }
  $('planet').value = state.planet.name;
  stale = true;
});
connection.addEventListener('planet', ({ detail }) => {
  const { planets } = connection.welcome;
  planets.splice(planets.findIndex(({ name }) => name === detail.name), 1, detail);
  if (detail.name === state.planet.name) state.renew(detail);
});
connection.addEventListener('away', ({ detail }) => notices.away(detail));
connection.addEventListener('fault', ({ detail }) => notices.say(detail));

/** Asks for the main picture where it must be another. */
function look() {
  const moving = performance.now() - state.moved_ms < STILL_MS;
  if (!stale && (moving || !coarse)) return moving;
  const { lens } = pilot;
  const size = resolution.size(lens.width, lens.height, connection.welcome.limits.pixels, moving);
  const took = moving ? (trip_ms) => resolution.took(trip_ms) : undefined;
  frames.request({ ...state.view(), size }, { pose: state.pose, lens, planet: state.planet.name, moving, took });
  if (!frames.outstanding) frames.send();
  [stale, coarse] = [false, moving];
  return moving;
}

let last_ms = performance.now();
function loop(now_ms) {
  const seconds = Math.max(now_ms - last_ms, 0) / 1000;
  last_ms = now_ms;
  if (state.planet) {
    keys.tick(seconds);
    sun.tick(seconds);
    pilot.tick(Math.min(seconds, 0.2));
    warp.tick();
    instruments.tick();
    share.tick();
    if (connection.connected) {
      const moving = look();
      inset.tick(moving);
      if (!pilot.flight) readout.tick();
    }
  }
  requestAnimationFrame(loop);
}

/** What tests may know. */
window.relief = Object.freeze({
  get connected() { return connection.connected; },
  get planet() { return state.planet?.name ?? null; },
  get pose() { return state.pose && { ...state.pose }; },
  get view() { return frames.shown?.header.view ?? 0; },
  get complete() { return frames.shown?.header.complete ?? false; },
  get triangles() { return frames.shown?.header.stats.triangles ?? 0; },
  get sun() { return frames.shown?.header.sun ?? null; },
  get size() { return frames.shown?.header.size ?? null; },
  get under() { return readout.last; },
  /** The camera is on its way by itself. */
  get moving() { return Boolean(pilot.flight || pilot.zoom); },
  get distance_m() { return measure.result?.distance_m ?? null; },
  /** The picture of the view as it is, whole and in all pixels, is shown. */
  get settled() {
    const note = frames.shown?.note;
    const idle = !stale && !coarse && !frames.outstanding && !frames.next && !this.moving;
    return Boolean(idle && connection.connected && note && !note.moving && note.pose === state.pose && this.complete);
  },
});

connection.attach();
requestAnimationFrame(loop);
