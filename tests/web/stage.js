// What all tests stand on: a globe and a plane, a daemon that serves them, a browser, and pages that must not
// complain on their consoles.

import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

const ROOT = fileURLToPath(new URL('../../', import.meta.url));
const RELIEFD = process.env.RELIEFD ?? join(ROOT, 'target/release/reliefd');
const BAKE = process.env.RELIEF_BAKE ?? join(ROOT, 'target/release/relief-bake');
const CHROMIUM = process.env.CHROMIUM ?? '/usr/bin/chromium';
const SHOTS = join(ROOT, 'target/web-screenshots');
const PATIENCE_MS = 20_000;
export const DESK = { width: 1280, height: 720 };
export const PHONE = { width: 375, height: 812 };

const stage = {};

before(async () => {
  mkdirSync(SHOTS, { recursive: true });
  stage.folder = mkdtempSync(join(tmpdir(), 'relief-web-'));
  stage.files = [
    bake('earth', 'earth_etopo1_6min.tif', '--m', '8', '--vertical', 'egm96'),
    bake('sierra', 'sierra_albers_30m.tif', '--body', 'plane', '--vertical', 'as-given'),
  ];
  stage.daemon = await serve();
  stage.browser = await chromium.launch({
    executablePath: CHROMIUM,
    args: [
      '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
      '--disable-component-update', '--disable-sync',
    ],
  });
});

after(async () => {
  await stage.browser?.close();
  await stage.daemon?.stop();
  rmSync(stage.folder, { recursive: true, force: true });
});

function bake(name, source, ...options) {
  const file = join(stage.folder, `${name}.relief`);
  execFileSync(BAKE, ['bake', join(ROOT, 'tests/data', source), ...options, '-o', file], { stdio: 'pipe' });
  return file;
}

/** Starts a daemon: {address, stop}. `stop` ends it with a signal and waits until it is gone. */
export async function serve(listen = 'auto') {
  const args = ['serve', ...stage.files, '--listen', listen, '--backend', 'cpu', '--headless'];
  const child = spawn(RELIEFD, args, { stdio: ['ignore', 'pipe', 'pipe'] });
  const gone = new Promise((done) => { child.once('exit', done); });
  let said = '';
  child.stderr.on('data', (data) => { said += data; });
  const address = await new Promise((found, failed) => {
    let out = '';
    child.stdout.on('data', (data) => {
      out += data;
      const [url] = /http:\/\/\S+/.exec(out) ?? [];
      if (url && out.includes('\n')) found(url);
    });
    child.once('exit', (code) => failed(new Error(`reliefd ended with ${code}: ${said}`)));
    child.once('error', failed);
  });
  const stop = (signal = 'SIGTERM') => {
    child.kill(signal);
    return gone;
  };
  return { address, stop };
}

/**
 * Runs a test with a page on the daemon. The page's console must hold no error but those that match
 * `tolerated`; a screenshot named `name` is kept.
 */
export async function withPage(name, run, { hash = '', viewport = DESK, address, tolerated } = {}) {
  const context = await stage.browser.newContext({
    viewport, hasTouch: viewport === PHONE, isMobile: viewport === PHONE, acceptDownloads: true,
  });
  const errors = [];
  try {
    const page = await context.newPage();
    page.setDefaultTimeout(PATIENCE_MS);
    page.on('console', (message) => { if (message.type() === 'error') errors.push(message.text()); });
    page.on('pageerror', (error) => errors.push(error.message));
    await page.goto((address ?? stage.daemon.address) + hash);
    await settled(page);
    await run(page);
    await page.screenshot({ path: join(SHOTS, `${name}.png`) });
  } finally {
    await context.close();
  }
  assert.deepEqual(errors.filter((text) => !tolerated?.test(text)), [], 'errors on the console');
}

/** Waits until the whole picture of the view as it is is shown. */
export const settled = (page) => until(page, () => window.relief?.settled);

/** Waits until a function in the page is true. */
export const until = (page, test, arg) => page.waitForFunction(test, arg, { timeout: PATIENCE_MS, polling: 50 });

/** Waits until an asynchronous question is answered with true. */
export async function eventually(question) {
  const late = Date.now() + PATIENCE_MS;
  while (!await question()) {
    assert.ok(Date.now() < late, `within ${PATIENCE_MS} ms: ${question}`);
    await sleep(50);
  }
}

/** A field of window.relief. */
export const relief = (page, field) => page.evaluate((name) => window.relief[name], field);

/** What a canvas shows, as 64 x 36 pixels of red, green and blue. */
export function picture(page, canvas = '#view') {
  return page.evaluate((selector) => {
    const small = new OffscreenCanvas(64, 36).getContext('2d');
    small.drawImage(document.querySelector(selector), 0, 0, 64, 36);
    return [...small.getImageData(0, 0, 64, 36).data].filter((_, k) => k % 4 !== 3);
  }, canvas);
}

/** Mean difference of two pictures, 0 to 255. */
export const difference = (a, b) => a.reduce((sum, value, k) => sum + Math.abs(value - b[k]), 0) / a.length;

/** True where nothing is to be seen. */
export const isBlank = (shown) => Math.max(...shown) - Math.min(...shown) < 40;
