// A bar of the time that each stage of the shown picture took.
import {byId, make} from './dom.js';

const kNames = ['guides', 'match', 'vote', 'compose', 'encode'];

/** @param {{name: string, ms: number}[]} stages @param {number} total milliseconds from the request to the picture */
export function showTimes(stages, total) {
  const box = byId('timing', HTMLElement), bar = byId('timing-bar', HTMLElement),
        list = byId('timing-list', HTMLElement);
  const shown = stages.filter((stage) => stage.ms >= 0.05 && stage.name !== 'total');
  box.hidden = shown.length === 0;
  const sum = shown.reduce((ms, stage) => ms + stage.ms, 0);
  const rows = shown.map((stage, index) => {
    const known = kNames.indexOf(stage.name);
    const colour = `var(--stage-${known >= 0 ? known + 1 : (index % 5) + 1})`;
    const part = make('i');
    part.style.flex = `${stage.ms / sum} 0 0`;
    part.style.background = colour;
    const row =
        make('div', {}, make('dt', {textContent: stage.name}), make('dd', {textContent: milliseconds(stage.ms)}));
    row.style.setProperty('--colour', colour);
    return {part, row};
  });
  bar.replaceChildren(...rows.map(({part}) => part));
  list.replaceChildren(...rows.map(({row}) => row));
  const text = `${shown.map((stage) => `${stage.name} ${milliseconds(stage.ms)}`).join(', ')} ms; ` +
      `${milliseconds(total)} ms until it was here`;
  bar.setAttribute('aria-label', text);
  bar.title = text;
}

/** @param {number} ms */
function milliseconds(ms) {
  return ms < 10 ? ms.toFixed(1) : String(Math.round(ms));
}
