// The camera moves: by drags, the wheel and keys.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { difference, picture, relief, settled, until, withPage } from './stage.js';

const HIMALAYA = '#planet=earth&at=86.9,25.5,250000,0,-40';
const NORTH_POLE = '#planet=earth&at=20,88,3000000,0,-90';

/** Drags from one pixel to another. */
async function drag(page, from, to, options = {}) {
  await page.mouse.move(...from);
  await page.mouse.down(options);
  await page.mouse.move((from[0] + to[0]) / 2, (from[1] + to[1]) / 2, { steps: 4 });
  await page.mouse.move(...to, { steps: 4 });
  await page.mouse.up(options);
  await settled(page);
}

/** Longitude and latitude under the pointer in the picture that is shown. */
async function under(page, pixel) {
  await page.mouse.move(...pixel);
  await until(page, ([x, y]) => {
    const { settled, under: answer, view } = window.relief;
    return settled && answer?.view === view && answer.pixel[0] === x && answer.pixel[1] === y && answer.place;
  }, pixel);
  const { place } = await relief(page, 'under');
  return [place.x, place.y];
}

/** Turns the wheel and waits until the camera stands still. */
async function wheel(page, notches) {
  for (let k = 0; k < Math.abs(notches); k += 1) await page.mouse.wheel(0, 240 * Math.sign(notches));
  await until(page, () => !window.relief.moving);
}

test('a drag moves the planet, and the point stays under the pointer', () => withPage('drag', async (page) => {
  const [before, pose] = [await picture(page), await relief(page, 'pose')];
  const grabbed = await under(page, [560, 300]);
  await drag(page, [560, 300], [700, 420]);
  const after = await relief(page, 'pose');
  assert.ok(after.x < pose.x - 3 && after.y > pose.y + 3, JSON.stringify(after));
  assert.equal(after.heading_deg, pose.heading_deg);
  assert.equal(after.height_m, pose.height_m);
  assert.ok(difference(before, await picture(page)) > 3);
  const dropped = await under(page, [700, 420]);
  assert.ok(Math.hypot(grabbed[0] - dropped[0], grabbed[1] - dropped[1]) < 0.4, `${grabbed} ${dropped}`);
}));

test('a drag goes over the pole without a jump', () => withPage('pole', async (page) => {
  const grabbed = await under(page, [600, 250]);
  await drag(page, [600, 250], [640, 500]);
  const dropped = await under(page, [640, 500]);
  // Metres of latitude and longitude shrink here: compare on the sphere.
  const normal = ([lon, lat]) => {
    const [a, b] = [(lon * Math.PI) / 180, (lat * Math.PI) / 180];
    return [Math.cos(b) * Math.cos(a), Math.cos(b) * Math.sin(a), Math.sin(b)];
  };
  const [p, q] = [normal(grabbed), normal(dropped)];
  assert.ok(Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]) < 0.01, `${grabbed} ${dropped}`);
}, { hash: NORTH_POLE }));

test('a drag with the right button tilts and turns about the pointer', () => withPage('tilt', async (page) => {
  const pose = await relief(page, 'pose');
  const pivot = await under(page, [640, 400]);
  await drag(page, [640, 400], [720, 360], { button: 'right' });
  const after = await relief(page, 'pose');
  assert.ok(after.pitch_deg > pose.pitch_deg + 5, JSON.stringify(after));
  assert.ok(after.heading_deg > 10 && after.heading_deg < 40, JSON.stringify(after));
  const still = await under(page, [640, 400]);
  assert.ok(Math.hypot(pivot[0] - still[0], pivot[1] - still[1]) < 0.2, `${pivot} ${still}`);
  await page.click('#compass');
  await until(page, () => window.relief.settled && window.relief.pose.heading_deg === 0);
}, { hash: HIMALAYA }));

test('the wheel zooms to the ground, where the camera stays above it', () => withPage('ground', async (page) => {
  const target = await under(page, [600, 330]);
  let pose = await relief(page, 'pose');
  for (let k = 0; k < 12 && pose.height_m > 1500; k += 1) {
    await wheel(page, -4);
    pose = await relief(page, 'pose');
  }
  assert.ok(pose.height_m < 1500, JSON.stringify(pose));
  assert.ok(Math.hypot(pose.x - target[0], pose.y - target[1]) < 0.5, `${JSON.stringify(pose)} ${target}`);
  for (let k = 0; k < 4; k += 1) await wheel(page, -4);
  await settled(page);
  pose = await relief(page, 'pose');
  const answer = await page.request.get(new URL(`/v1/planets/earth/height?lon=${pose.x}&lat=${pose.y}`, page.url()).href);
  const { height_m } = await answer.json();
  const above_m = pose.height_m - height_m;
  assert.ok(above_m > 1.9 && above_m < 60, `${above_m} m above the ground`);
}));

test('the wheel goes out as far as three radii and no farther', () => withPage('far', async (page) => {
  await page.mouse.move(640, 360);
  for (let k = 0; k < 3; k += 1) await wheel(page, 4);
  await settled(page);
  const { height_m } = await relief(page, 'pose');
  assert.ok(height_m > 1.2e7 && height_m <= 3 * 6_378_137, `${height_m}`);
}));

test('zooming out from a slanting view ends above the planet', () => withPage('out', async (page) => {
  await page.mouse.move(640, 500);
  for (let k = 0; k < 5; k += 1) await wheel(page, 4);
  await settled(page);
  const { height_m, pitch_deg } = await relief(page, 'pose');
  assert.ok(height_m > 1.2e7 && pitch_deg < -85, `${height_m} ${pitch_deg}`);
  assert.ok(await relief(page, 'triangles') > 100);
}, { hash: '#planet=earth&at=86.9,27,30000,40,-5' }));

test('zooming in and out again comes back', () => withPage('there-and-back', async (page) => {
  const pose = await relief(page, 'pose');
  const place = await under(page, [840, 260]);
  for (const notches of [-4, -4, 4, 4]) {
    await wheel(page, notches);
    const now = await under(page, [840, 260]);
    assert.ok(Math.hypot(now[0] - place[0], now[1] - place[1]) < 0.3, `${now} ${place}`);
  }
  const { x, y, height_m } = await relief(page, 'pose');
  assert.ok(Math.hypot(x - pose.x, y - pose.y) < 0.1 && Math.abs(height_m / pose.height_m - 1) < 1e-3, `${x} ${y} ${height_m}`);
}));

test('keys move, turn, tilt, zoom and go home', () => withPage('keys', async (page) => {
  const home = await relief(page, 'pose');
  const grew = async (key, field, sign) => {
    const before = (await relief(page, 'pose'))[field];
    await page.keyboard.down(key);
    await until(page, ([name, from, way]) => way * (window.relief.pose[name] - from) > 0, [field, before, sign]);
    await page.keyboard.up(key);
  };
  await grew('ArrowUp', 'y', 1);
  await grew('s', 'y', -1);
  await grew('ArrowRight', 'x', 1);
  await grew('a', 'x', -1);
  await grew('+', 'height_m', -1);
  await grew('-', 'height_m', 1);
  await grew('r', 'pitch_deg', 1);
  await grew('f', 'pitch_deg', -1);
  await grew('e', 'heading_deg', 1);
  await page.keyboard.press('n');
  await until(page, () => window.relief.pose.heading_deg === 0);
  await page.keyboard.press('h');
  await until(page, () => window.relief.settled);
  assert.deepEqual(await relief(page, 'pose'), home);
  await page.keyboard.press('?');
  assert.equal(await page.isVisible('#help'), true);
  await page.keyboard.press('Escape');
  assert.equal(await page.isVisible('#help'), false);
}));

test('keys do what a focused control says, not what the map would', () => withPage('focus', async (page) => {
  await page.focus('#inset-toggle');
  await page.keyboard.press(' ');
  assert.equal(await page.isVisible('#inset'), true);
  assert.equal(await page.getAttribute('#play', 'aria-pressed'), 'false');
  const pose = await relief(page, 'pose');
  await page.focus('#place');
  await page.keyboard.type('wasd+nmh');
  await page.focus('#overlay [aria-checked=true]');
  await page.keyboard.press('ArrowRight');
  assert.equal(await page.getAttribute('#overlay [data-value=wireframe]', 'aria-checked'), 'true');
  assert.deepEqual(await relief(page, 'pose'), pose);
}));
