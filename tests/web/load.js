// The page loads, shows the planet and fits its window.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { PHONE, difference, isBlank, picture, relief, withPage } from './stage.js';

test('a frame arrives and is drawn', () => withPage('load', async (page) => {
  assert.equal(await relief(page, 'connected'), true);
  assert.equal(await relief(page, 'planet'), 'earth');
  assert.deepEqual(await relief(page, 'size'), [1280, 720]);
  assert.ok(await relief(page, 'triangles') > 100);
  assert.equal(isBlank(await picture(page)), false);
  assert.match(await page.textContent('#attribution'), /^Earth · .* between nodes · CPU/);
}));

test('an empty canvas is blank, and two empty ones do not differ', () => withPage('blank', async (page) => {
  await page.evaluate(() => {
    const canvas = document.querySelector('#view');
    canvas.getContext('2d').fillRect(0, 0, canvas.width, canvas.height);
  });
  const empty = await picture(page);
  assert.equal(isBlank(empty), true);
  assert.equal(difference(empty, empty), 0);
}));

test('a second viewer gets frames of its own', () => withPage('viewers', (one) => withPage('viewer-2', async (two) => {
  await two.click('#zoom-in');
  await two.waitForFunction(() => window.relief.settled && window.relief.view > 1);
  for (const page of [one, two]) assert.equal(isBlank(await picture(page)), false);
  const [first, second] = [await relief(one, 'pose'), await relief(two, 'pose')];
  assert.ok(second.height_m < 0.6 * first.height_m);
  assert.ok(difference(await picture(one), await picture(two)) > 5);
})));

test('a phone shows all of it without scrolling sideways', () => withPage('phone', async (page) => {
  const wide = () => page.evaluate(() => Math.max(...['html', 'body', '#panel'].map((name) => {
    const element = document.querySelector(name);
    return element.scrollWidth - element.clientWidth;
  })));
  assert.equal(await wide(), 0);
  assert.equal(await page.isVisible('#panel'), false);
  await page.tap('#panel-toggle');
  assert.equal(await page.isVisible('#panel'), true);
  await page.tap('#light [data-value=time]');
  assert.equal(await wide(), 0);
  const outside = await page.evaluate(() => [...document.querySelectorAll('button, input, select')]
    .filter((element) => element.checkVisibility())
    .map((element) => [element.id || element.textContent, element.getBoundingClientRect()])
    .filter(([, box]) => box.left < 0 || box.right > window.innerWidth)
    .map(([name]) => name));
  assert.deepEqual(outside, []);
}, { viewport: PHONE }));

test('all controls have names', () => withPage('names', async (page) => {
  const unnamed = await page.evaluate(() => [...document.querySelectorAll('button, input, select')]
    .filter((element) => {
      const by = document.getElementById(element.getAttribute('aria-labelledby'));
      const label = by ?? element.closest('label');
      return !(element.ariaLabel || (label ?? element).textContent.trim());
    })
    .map((element) => element.outerHTML));
  assert.deepEqual(unnamed, []);
}));
