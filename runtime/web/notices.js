// What the user must know: toasts for what went wrong once, a banner while the daemon is away.

import { $, show } from './elements.js';

const STAY_MS = 9000;
const MOST = 3;

export class Notices {
  constructor(retry) {
    $('away-again').onclick = retry;
  }

  /** A toast: what was found, the rule, the remedy; or just what. */
  say({ what, rule, remedy, mild = false }) {
    const key = `${what}${rule}`;
    const twin = [...$('toasts').children].find((toast) => toast.dataset.key === key);
    twin?.remove();
    const toast = document.createElement('div');
    toast.className = mild ? 'toast mild glass' : 'toast glass';
    toast.dataset.key = key;
    const parts = [['strong', what], ['p', rule], ['p', remedy]].filter(([, text]) => text);
    toast.append(...parts.map(([tag, text]) => Object.assign(document.createElement(tag), { textContent: text })));
    const close = Object.assign(document.createElement('button'), { className: 'bare', textContent: '×' });
    close.setAttribute('aria-label', 'Dismiss');
    close.onclick = () => toast.remove();
    toast.append(close);
    $('toasts').append(toast);
    while ($('toasts').children.length > MOST) $('toasts').firstChild.remove();
    setTimeout(() => toast.remove(), mild ? STAY_MS / 3 : STAY_MS);
  }

  /** The daemon is away; `again_ms` is when the page tries next, null when it does not. */
  away({ what, rule, remedy, again_ms }) {
    $('away-what').textContent = what;
    $('away-rule').textContent = rule ?? '';
    $('away-remedy').textContent = remedy ?? '';
    show($('away'), true);
    clearInterval(this.counting);
    const until = performance.now() + again_ms;
    const count = () => {
      const left_s = Math.ceil((until - performance.now()) / 1000);
      $('away-when').textContent = again_ms === null ? '' : left_s > 0 ? `Trying again in ${left_s} s` : 'Trying …';
    };
    count();
    this.counting = setInterval(count, 250);
  }

  back() {
    clearInterval(this.counting);
    show($('away'), false);
  }
}
