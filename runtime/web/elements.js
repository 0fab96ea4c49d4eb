// The page's elements: found, shown, and groups of choices.

/** The element with an id. */
export const $ = (id) => document.getElementById(id);

/** Shows or hides. */
export const show = (element, shown) => { element.hidden = !shown; };

/**
 * Fills a group of buttons of which one is chosen: `options` are [value, label, title?]. Returns a
 * function that marks a value as chosen.
 */
export function choices(group, options, chosen) {
  const buttons = options.map(([value, label, title]) => {
    const button = document.createElement('button');
    Object.assign(button, { type: 'button', textContent: label, title: title ?? '' });
    button.setAttribute('role', 'radio');
    button.dataset.value = value;
    button.addEventListener('click', () => chosen(value));
    return button;
  });
  group.replaceChildren(...buttons);
  group.onkeydown = (event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    const at = buttons.indexOf(document.activeElement);
    if (!step || at < 0) return;
    event.preventDefault();
    const next = buttons[(at + step + buttons.length) % buttons.length];
    next.focus();
    next.click();
  };
  return (value) => {
    for (const button of buttons) {
      const on = button.dataset.value === value;
      button.setAttribute('aria-checked', on);
      button.tabIndex = on ? 0 : -1;
    }
  };
}

/** The filled part of a slider, for its style. */
export function fill(slider) {
  const share = (slider.value - slider.min) / (slider.max - slider.min);
  slider.style.setProperty('--filled', `${100 * share}%`);
}
