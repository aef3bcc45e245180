// Keeping what was found: the style's file, the command line, and downloads.
import {call, CallError} from './api.js';
import {byId, download, make} from './dom.js';

/** @typedef {import('./api.js').State} State */

export class Keeper {
  /**
   * @param {import('./store.js').Store} store
   * @param {{announce: (text: string) => void, error: (error: unknown) => void}} page
   */
  constructor(store, page) {
    this.store = store;
    this.page = page;
    this.dialog = byId('save-as-dialog', HTMLDialogElement);
    this.name = byId('save-as-name', HTMLInputElement);
    byId('save', HTMLElement).addEventListener('click', () => void this.save());
    byId('save-as', HTMLElement).addEventListener('click', () => this.askName());
    byId('copy-command', HTMLElement).addEventListener('click', () => void this.copyCommand());
    byId('download', HTMLElement).addEventListener('click', () => {
      byId('download-error', HTMLElement).textContent = '';
      byId('download-dialog', HTMLDialogElement).showModal();
    });
    byId('save-as-form', HTMLFormElement).addEventListener('submit', (event) => {
      event.preventDefault();
      void this.saveAs();
    });
    byId('download-form', HTMLFormElement).addEventListener('submit', (event) => {
      event.preventDefault();
      void this.download(/** @type {HTMLFormElement} */ (event.target));
    });
    store.listen((state) => this.update(state));
  }

  get style() { return this.store.state.styles.find((style) => style.id === this.store.state.style); }

  /** @param {State} state */
  update(state) {
    const hasChanges = Object.keys(state.keys).length > 0, writable = !!this.style?.writable;
    const save = byId('save', HTMLButtonElement);
    save.disabled = writable && !hasChanges;
    save.classList.toggle('primary', hasChanges);
    save.title = writable ? 'Write the changed keys into style.toml (Ctrl+S)'
                          : 'This style is not written over: save it as one of your own (Ctrl+S)';
    byId('save-as', HTMLButtonElement).disabled = this.style?.save_as === false;
  }

  /** A number that is being typed counts, and what is on its way arrives first. */
  async settle() {
    const field = document.activeElement;
    if (field instanceof HTMLInputElement || field instanceof HTMLTextAreaElement) {
      field.blur();
      field.focus();
    }
    await this.store.rested();
  }

  async save() {
    await this.settle();
    if (!this.style?.writable) {
      this.askName();
      return;
    }
    if (!Object.keys(this.store.state.keys).length) {
      this.page.announce('nothing to save');
      return;
    }
    try {
      const {saved, saves} = await (await call('POST', '/api/save')).json();
      this.store.hearSaves(saves);
      this.page.announce(`saved ${saved}`);
      await this.store.refresh();
    } catch (error) {
      if (error instanceof CallError && error.status === 403) this.askName(error.message);
      else this.page.error(error);
    }
  }

  /** @param {string} [why] */
  askName(why = '') {
    byId('save-as-error', HTMLElement).textContent = why;
    this.name.value = `my-${this.store.state.style}`;
    this.dialog.showModal();
    this.name.select();
  }

  async saveAs() {
    const error = byId('save-as-error', HTMLElement);
    error.textContent = '';
    try {
      const {saved, saves} = await (await call('POST', '/api/save-as', {json: {name: this.name.value}})).json();
      this.dialog.close();
      this.page.announce(`saved ${saved ?? 'the style'}`);
      this.store.hearSaves(saves);
      await this.store.refresh();
    } catch (failed) {
      error.textContent = failed instanceof Error ? failed.message : String(failed);
    }
  }

  async copyCommand() {
    await this.settle();
    try {
      const {command} = await (await call('POST', '/api/export', {json: {what: 'command'}})).json();
      document.documentElement.dataset.command = command;
      await copyText(command);
      this.page.announce('command copied');
    } catch (error) {
      this.page.error(error);
    }
  }

  /** @param {HTMLFormElement} form */
  async download(form) {
    const format = String(new FormData(form).get('download')), isStyle = format === 'style';
    const error = byId('download-error', HTMLElement);
    const button = form.querySelector('button[type="submit"]');
    error.textContent = '';
    button?.setAttribute('disabled', '');
    try {
      const {scene, style} = this.store.state;
      const response = await call('POST', '/api/export', {json: isStyle ? {what: 'style'} : {what: 'picture', format}});
      download(await response.blob(), isStyle ? 'style.toml' : `${scene}-${style}.${format}`);
      byId('download-dialog', HTMLDialogElement).close();
      this.page.announce('downloaded');
    } catch (failed) {
      error.textContent = failed instanceof Error ? failed.message : String(failed);
    } finally {
      button?.removeAttribute('disabled');
    }
  }
}

/** @param {string} text */
async function copyText(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    // Without leave for the clipboard: the old way, from a field.
    const field = make('textarea', {value: text, className: 'unseen'});
    document.body.append(field);
    field.select();
    const copied = document.execCommand('copy');
    field.remove();
    if (!copied) throw new Error(`The browser does not let the page copy. The command is: ${text}`);
  }
}
