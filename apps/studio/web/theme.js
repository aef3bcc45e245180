// Dark or light: as the system says, until the switch says otherwise.
import {byId} from './dom.js';
import {store, stored} from './shortcuts.js';

const kStored = 'scumble.theme';

export function followTheme() {
  const light = matchMedia('(prefers-color-scheme: light)');
  const apply = () => {
    const theme = stored(kStored) ?? (light.matches ? 'light' : 'dark');
    document.documentElement.dataset.theme = theme;
    byId('theme', HTMLElement).setAttribute('aria-label', theme === 'dark' ? 'Light page' : 'Dark page');
    byId('theme', HTMLElement).title = theme === 'dark' ? 'Light page' : 'Dark page';
  };
  light.addEventListener('change', apply);
  byId('theme', HTMLElement).addEventListener('click', () => {
    store(kStored, document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark');
    apply();
  });
  apply();
}
