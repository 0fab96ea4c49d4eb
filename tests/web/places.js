// Places: the search, the measure, the bookmark and the saved picture.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { difference, isBlank, picture, relief, settled, until, withPage } from './stage.js';

test('the search flies to coordinates', () => withPage('search', async (page) => {
  await page.fill('#place', '27°59\'17"N 86°55\'31"E');
  await page.keyboard.press('Enter');
  await until(page, () => window.relief.settled && Math.abs(window.relief.pose.x - 86.925) < 0.1);
  const { y, height_m } = await relief(page, 'pose');
  assert.ok(y > 8 && y < 28, `south of the place, and looking at it: ${y}`);
  assert.ok(height_m < 3e6, `${height_m}`);
  await until(page, () => /^27\.\d+° N 86\.\d+° E|^28\.\d+° N/.test(document.querySelector('#readout').textContent));
}));

test('coordinates are read as people write them', () => withPage('coordinates', async (page) => {
  const read = (text) => page.evaluate(async (given) => {
    const { parse } = await import('/page/coordinates.js');
    try {
      return parse(given, { plane: false }).map((value) => Number(value.toFixed(4)));
    } catch (error) {
      return error.message;
    }
  }, text);
  const place = [86.925, 27.9881];
  for (const text of ['27.9881, 86.925', '27.9881 86.925', '27.9881N 86.925E', 'N27.9881 E86.925', '86.925E, 27.9881N',
    '27°59\'17.16"N 86°55\'30"E', '27° 59.286′ N, 86° 55.5′ E', '27 59 17.16 86 55 30', '27:59:17.16; 86:55:30']) {
    assert.deepEqual(await read(text), place, text);
  }
  assert.deepEqual(await read('-33.5, -70.25'), [-70.25, -33.5]);
  assert.deepEqual(await read('33.5 S 70.25 W'), [-70.25, -33.5]);
  assert.deepEqual(await read('10, 359'), [-1, 10]);
  for (const text of ['', 'Everest', '91, 0', '0, 400', '1 2 3', '10N 20S', '10 70 0, 20']) {
    assert.match(await read(text), /: .*\. /, text);
  }
}));

test('what is no place is refused with value, rule and remedy', () => withPage('refused', async (page) => {
  const pose = await relief(page, 'pose');
  await page.fill('#place', '95, 10');
  await page.keyboard.press('Enter');
  await page.waitForSelector('#place-said:visible');
  assert.match(await page.textContent('#place-said'), /latitude of 95.*-90 to 90.*Write/);
  assert.deepEqual(await relief(page, 'pose'), pose);
}));

test('the measure agrees with GeographicLib', () => withPage('measure', async (page) => {
  await page.click('#measure');
  await page.fill('#ruler-from', '40.6N 73.8W');
  await page.fill('#ruler-to', '51.6N 0.5W');
  await page.keyboard.press('Enter');
  await until(page, () => window.relief.distance_m !== null);
  // GeodSolve -i -p 6, WGS 84.
  assert.ok(Math.abs(await relief(page, 'distance_m') - 5_551_759.400319) < 1e-4);
  assert.match((await page.textContent('#ruler-said')).replace(/\s/g, ' '), /^5 551\.759400 km · sets out at 51\.20°/);
  const ink = () => page.evaluate(() => {
    const marks = document.querySelector('#marks');
    const { data } = marks.getContext('2d').getImageData(0, 0, marks.width, marks.height);
    return data.filter((value, k) => k % 4 === 3 && value > 200).length;
  });
  assert.ok(await ink() > 200, 'the line is drawn');
  await page.keyboard.press('Escape');
  assert.equal(await ink(), 0);
}));

test('two clicks measure, too', () => withPage('clicks', async (page) => {
  await page.keyboard.press('m');
  await page.mouse.click(600, 300);
  await until(page, () => document.querySelector('#ruler-from').value !== '');
  await page.mouse.click(700, 420);
  await until(page, () => window.relief.distance_m !== null);
  const distance_m = await relief(page, 'distance_m');
  assert.ok(distance_m > 1e6 && distance_m < 6e6, `${distance_m}`);
}));

test('the page’s geodesics end where the daemon says', () => withPage('geodesic', async (page) => {
  const [x, y, azimuth] = await page.evaluate(async () => {
    const { direct } = await import('/page/geodesic.js');
    return direct({ a_m: 6378137, b_m: 6356752.314245179 }, -73.8, 40.6, 51.19888284558, 5_551_759.400319);
  });
  assert.ok(Math.abs(x + 0.5) < 1e-7 && Math.abs(y - 51.6) < 1e-7, `${x} ${y}`);
  assert.ok(Math.abs(azimuth - 107.82177673551) < 1e-6, `${azimuth}`);
}));

test('a bookmark restores the view', async () => {
  let hash;
  let shown;
  await withPage('bookmark', async (page) => {
    await page.click('#light [data-value=time]');
    await page.click('#overlay [data-value=lod]');
    await page.click('#shadow [data-value=off]');
    await page.click('#zoom-in');
    await settled(page);
    // The address follows a few times a second.
    await until(page, () => {
      const high = window.relief.pose.height_m.toPrecision(8);
      return location.hash.includes(`,${Number(high)},`) && /shadow=off/.test(location.hash);
    });
    hash = await page.evaluate(() => location.hash);
    shown = await picture(page);
  });
  await withPage('bookmark-again', async (page) => {
    assert.equal(await page.evaluate(() => location.hash), hash);
    assert.ok(difference(shown, await picture(page)) < 1);
    assert.equal(await page.getAttribute('#overlay [data-value=lod]', 'aria-checked'), 'true');
  }, { hash });
});

test('another address in the same page is another view', () => withPage('address', async (page) => {
  await page.evaluate(() => { location.hash = '#planet=sierra&shadow=soft'; });
  await until(page, () => window.relief.settled && window.relief.planet === 'sierra');
  await page.evaluate(() => { location.hash = '#planet=earth&at=-70,-20,900000,30,-50'; });
  await until(page, () => window.relief.settled && window.relief.planet === 'earth' && window.relief.pose.heading_deg === 30);
  assert.equal(await page.inputValue('#planet'), 'earth');
}));

test('a link is copied without the token', () => withPage('link', async (page) => {
  await page.context().grantPermissions(['clipboard-read', 'clipboard-write']);
  await page.click('#link');
  await page.waitForSelector('.toast');
  const copied = new URL(await page.evaluate(() => navigator.clipboard.readText()));
  assert.equal(copied.searchParams.get('token'), null);
  assert.match(copied.hash, /^#planet=earth&at=15,20,/);
}, { hash: '?token=secret' }));

test('a bookmark of nonsense shows all of the planet', () => withPage('nonsense', async (page) => {
  const pose = await relief(page, 'pose');
  assert.equal(pose.pitch_deg, -90);
  assert.equal(isBlank(await picture(page)), false);
}, { hash: '#planet=earth&at=1,2,x,NaN,7&time=never&overlay=<b>&error=-3&shadow=' }));

test('a PNG is saved', () => withPage('save', async (page) => {
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('#save')]);
  assert.equal(download.suggestedFilename(), 'relief-earth.png');
  const bytes = readFileSync(await download.path());
  assert.equal(bytes.subarray(1, 4).toString(), 'PNG');
  assert.deepEqual([bytes.readUInt32BE(16), bytes.readUInt32BE(20)], [1280, 720]);
}));
