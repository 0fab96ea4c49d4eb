// What the picture shows: the sun, shadows, overlays and the threshold.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { difference, eventually, isBlank, picture, relief, settled, until, withPage } from './stage.js';

const EVENING = '#planet=earth&at=86.9,26.5,150000,0,-60&time=2026-06-21T12:00:00Z';

/** Moves a slider to a value. */
const slide = (page, id, value) => page.evaluate(([name, to]) => {
  const slider = document.getElementById(name);
  slider.value = to;
  slider.dispatchEvent(new Event('input'));
}, [id, value]);

test('another time moves the sun and changes the picture', () => withPage('time', async (page) => {
  await page.click('#light [data-value=time]');
  await page.fill('#date', '2026-03-20');
  await slide(page, 'time', 720);
  await until(page, () => window.relief.settled && Math.abs(window.relief.sun[0]) < 3);
  const [noon, lit] = [await relief(page, 'sun'), await picture(page)];
  assert.ok(Math.abs(noon[1]) < 1, `the sun of an equinox: ${noon}`);
  await slide(page, 'time', 1080);
  await until(page, () => window.relief.settled && window.relief.sun[0] < -80);
  assert.ok(difference(lit, await picture(page)) > 10);
}));

test('the sun plays', () => withPage('play', async (page) => {
  await page.click('#light [data-value=time]');
  await until(page, () => window.relief.settled);
  const [before] = await relief(page, 'sun');
  await page.selectOption('#speed', '360');
  await page.click('#play');
  await until(page, (from) => Math.abs(window.relief.sun[0] - from) > 10, before);
  await page.click('#play');
  await settled(page);
}));

test('sunset puts the sun low over the middle of the picture', () => withPage('sunset', async (page) => {
  await page.click('[data-sun=set]');
  await until(page, () => window.relief.settled && document.querySelector('#clock').textContent !== '12:00 UTC');
  await until(page, () => /sun [2-6]\.\d°/.test(document.querySelector('#readout').textContent));
}, { hash: EVENING }));

test('shadows are soft, hard or off', () => withPage('shadow', async (page) => {
  const shown = {};
  for (const shadow of ['off', 'soft', 'hard']) {
    const view = await relief(page, 'view');
    await page.click(`#shadow [data-value=${shadow}]`);
    await until(page, (before) => window.relief.settled && window.relief.view > before, view);
    shown[shadow] = await picture(page);
  }
  assert.ok(difference(shown.off, shown.hard) > 0.8, `${difference(shown.off, shown.hard)}`);
  assert.ok(difference(shown.soft, shown.hard) > 0.02, `${difference(shown.soft, shown.hard)}`);
}, { hash: '#planet=sierra&sun=60,8' }));

test('each overlay is another picture', () => withPage('overlay', async (page) => {
  const shown = [await picture(page)];
  for (const overlay of ['wireframe', 'lod', 'pages', 'error']) {
    await page.click(`#overlay [data-value=${overlay}]`);
    await until(page, (name) => window.relief.settled && location.hash.includes(`overlay=${name}`), overlay);
    shown.push(await picture(page));
  }
  for (let a = 0; a < shown.length; a += 1) {
    for (let b = 0; b < a; b += 1) assert.ok(difference(shown[a], shown[b]) > 1, `${a} ${b}`);
  }
}));

test('the threshold changes the number of triangles', () => withPage('threshold', async (page) => {
  const counts = [];
  for (const exponent of [-2, 1, 4]) {
    await slide(page, 'threshold', exponent);
    await until(page, (e) => window.relief.settled && (e === 0 || location.hash.includes(`error=${2 ** e}`)), exponent);
    counts.push(await relief(page, 'triangles'));
  }
  assert.ok(counts[0] > 2 * counts[1] && counts[1] > counts[2], `${counts}`);
  assert.equal(await page.textContent('#threshold-said'), '16 px');
  assert.match(await page.textContent('#milliseconds'), /^[\d.]+ ms$/);
}));

test('the second camera shows a picture of its own', () => withPage('inset', async (page) => {
  await page.click('#inset-toggle');
  await eventually(async () => !isBlank(await picture(page, '#inset-view')));
  const map = await picture(page, '#inset-view');
  await page.click('#inset [data-value=tele]');
  await eventually(async () => difference(map, await picture(page, '#inset-view')) > 5);
  await page.click('#inset-close');
  assert.equal(await page.isVisible('#inset'), false);
}));
