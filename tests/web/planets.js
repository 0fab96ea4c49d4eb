// Several planets, one of them a plane.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { difference, picture, relief, settled, until, withPage } from './stage.js';

test('another planet is chosen, and the bookmark brings it back', () => withPage('planets', async (page) => {
  const globe = await picture(page);
  await page.selectOption('#planet', 'sierra');
  await until(page, () => window.relief.settled && window.relief.planet === 'sierra');
  assert.ok(difference(globe, await picture(page)) > 10);
  await until(page, () => location.hash.startsWith('#planet=sierra'));
  assert.deepEqual(await page.$$eval('#light button', (buttons) => buttons.map((one) => one.dataset.value)), ['map', 'point']);
  await page.reload();
  await settled(page);
  assert.equal(await relief(page, 'planet'), 'sierra');
}));

test('a plane is dragged, zoomed, measured and searched', () => withPage('plane', async (page) => {
  const pose = await relief(page, 'pose');
  await page.mouse.move(500, 400);
  await page.mouse.down();
  await page.mouse.move(560, 380, { steps: 5 });
  await page.mouse.up();
  await settled(page);
  const dragged = await relief(page, 'pose');
  assert.ok(dragged.x < pose.x - 100, JSON.stringify(dragged));
  await page.mouse.wheel(0, -400);
  await until(page, (high) => window.relief.settled && window.relief.pose.height_m < high, dragged.height_m);
  await page.keyboard.press('m');
  await page.mouse.click(600, 400);
  await until(page, () => document.querySelector('#ruler-from').value !== '');
  await page.mouse.click(700, 380);
  await until(page, () => window.relief.distance_m !== null);
  const [from, to] = await page.$$eval('#ruler input', (inputs) => inputs.map((one) => one.value.split(', ').map(Number)));
  const straight_m = Math.hypot(to[0] - from[0], to[1] - from[1]);
  assert.ok(Math.abs(await relief(page, 'distance_m') - straight_m) < 0.1, `${straight_m}`);
  await page.keyboard.press('Escape');
  await page.fill('#place', from.join(', '));
  await page.keyboard.press('Enter');
  await until(page, (x) => window.relief.settled && Math.abs(window.relief.pose.x - x) < 1, from[0]);
  await page.fill('#place', '1, 2');
  await page.keyboard.press('Enter');
  await page.waitForSelector('#place-said:visible');
  assert.match(await page.textContent('#place-said'), /the map reaches from/);
}, { hash: '#planet=sierra' }));
