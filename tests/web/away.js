// The daemon goes away and comes back.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { isBlank, picture, relief, serve, settled, until, withPage } from './stage.js';

test('the page says that the daemon is away, comes back by itself and goes on', async () => {
  const first = await serve();
  let second;
  try {
    await withPage('reconnect', async (page) => {
      await page.click('#zoom-in');
      await settled(page);
      const [pose, view] = [await relief(page, 'pose'), await relief(page, 'view')];
      await first.stop('SIGKILL');
      await page.waitForSelector('#away:visible');
      assert.equal(await relief(page, 'connected'), false);
      assert.match(await page.textContent('#away'), /lost|does not answer/);
      assert.match(await page.textContent('#away-remedy'), /reliefd serve/);
      await page.screenshot({ path: new URL('../../target/web-screenshots/away.png', import.meta.url).pathname });
      second = await serve(new URL(first.address).host);
      await until(page, (before) => window.relief.settled && window.relief.view > before, view);
      assert.equal(await page.isVisible('#away'), false);
      assert.deepEqual(await relief(page, 'pose'), pose);
      assert.equal(isBlank(await picture(page)), false);
    }, { address: first.address, tolerated: /WebSocket connection to|ERR_CONNECTION/ });
  } finally {
    await first.stop();
    await second?.stop();
  }
});
