// Every key of the page, with what it does.
import {isPressable} from './shortcuts.js';

/**
 * @param {{view: import('./view.js').View, orbit: import('./orbit.js').OrbitControl,
 *   compare: import('./compare.js').Compare, timeline: import('./timeline.js').Timeline,
 *   keeper: import('./keep.js').Keeper, brush: import('./brush.js').BrushPanel,
 *   assigner: import('./assign.js').Assigner, picker: import('./pick.js').Picker, shows: string[],
 *   setShow: (what: string) => void, step: (isUndo: boolean) => void}} page
 * @returns {import('./shortcuts.js').Shortcut[]}
 */
export function shortcutTable({view, orbit, compare, timeline, keeper, brush, assigner, picker, shows, setShow, step}) {
  /** The place in the middle of the picture's pane, and its pixel. */
  const middle = () => {
    const box = view.panes[0].getBoundingClientRect();
    const at = {x: box.left + box.width / 2, y: box.top + box.height / 2};
    return {at, pixel: view.pixelAt(at.x, at.y)};
  };
  return [
    {group: 'Camera', keys: 'Drag / Middle drag', does: 'orbit'},
    {group: 'Camera', keys: 'Shift + drag', does: 'pan'},
    {group: 'Camera', keys: 'Wheel / Page Up / Page Down', does: 'distance'},
    {group: 'Camera', keys: '← → ↑ ↓', does: 'orbit by 5°; with Shift: pan (picture focused)'},
    {
      group: 'Camera',
      keys: 'Home',
      does: 'the scene\'s camera: everything in view',
      key: ['Home'],
      run: () => orbit.home()
    },
    {
      group: 'Camera',
      keys: 'Numpad 1 / Numpad 3 / Numpad 7',
      does: 'front, right, top',
      code: ['Numpad1'],
      run: () => orbit.from(0, 0)
    },
    {group: 'Camera', keys: 'Numpad 0', does: 'the scene\'s camera', code: ['Numpad0'], run: () => orbit.home()},
    {
      group: 'Camera',
      keys: 'Numpad .',
      does: 'frame everything from here',
      code: ['NumpadDecimal'],
      run: () => orbit.frameAll()
    },

    {group: 'Picture', keys: '+ / −', does: 'zoom the picture', single: true, key: ['+', '='], run: () => view.step(1)},
    {group: 'Picture', keys: 'Ctrl + wheel', does: 'zoom the picture at the pointer'},
    {group: 'Picture', keys: 'Ctrl + drag', does: 'move the picture'},
    {
      group: 'Picture',
      keys: 'Z',
      does: 'fit, or pixel for pixel',
      single: true,
      key: ['z'],
      run: () => view.setZoom(view.zoom === null ? 1 : null)
    },
    {group: 'Picture', keys: '0', does: 'the picture', single: true, code: ['Digit0'], run: () => setShow('picture')},
    {
      group: 'Picture',
      keys: '1 – 7',
      does: `${shows.slice(1).join(', ')}; again: the picture`,
      single: true,
      code: shows.slice(1).map((_, index) => `Digit${index + 1}`),
      run: (event) => {
        const what = shows[Number(event.code.slice(-1))];
        setShow(what === shownNow() ? 'picture' : what);
      }
    },
    {
      group: 'Picture',
      keys: 'I',
      does: 'what stands in the middle',
      single: true,
      key: ['i'],
      run: () => {
        const {pixel} = middle();
        if (pixel) picker.soon(`${pixel.x} ${pixel.y}`, () => picker.pick(pixel));
      }
    },
    {
      group: 'Picture',
      keys: 'Enter',
      does: 'a style for what stands in the middle (picture focused)',
      key: ['Enter'],
      run: (event) => {
        const {pixel, at} = middle();
        if (event.target !== view.stage || !pixel) return false;
        void assigner.offer(pixel, at).catch(() => assigner.close());
      }
    },

    {group: 'Compare', keys: 'W', does: 'wipe', single: true, key: ['w'], run: () => compare.toggle('wipe')},
    {group: 'Compare', keys: 'S', does: 'side by side', single: true, key: ['s'], run: () => compare.toggle('side')},
    {
      group: 'Compare',
      keys: 'D',
      does: 'difference, four times as bright',
      single: true,
      key: ['d'],
      run: () => compare.toggle('difference')
    },
    {
      group: 'Compare',
      keys: 'Hold C',
      does: 'flip to B',
      single: true,
      key: ['c'],
      run: () => compare.flip(true),
      release: () => compare.flip(false)
    },

    {group: 'Work', keys: 'Ctrl + Z', does: 'undo', ctrl: true, shift: false, isUndo: true,
     key: ['z'], run: () => step(true)},
    {
      group: 'Work',
      keys: 'Ctrl + Shift + Z / Ctrl + Y',
      does: 'redo',
      ctrl: true,
      shift: true,
      isUndo: true,
      key: ['z'],
      run: () => step(false)
    },
    {
      group: 'Work',
      keys: 'Ctrl + S',
      does: 'save the style; while painting: the paint',
      ctrl: true,
      key: ['s'],
      run: () => void (brush.canPaint ? brush.save() : keeper.save())
    },
    {
      group: 'Work',
      keys: 'Space',
      does: 'play',
      key: [' '],
      run: (event) => {
        if (isPressable(event.target)) return false;
        timeline.toggle();
      }
    },
    {
      group: 'Work',
      keys: 'P',
      does: 'paint over the exemplar',
      single: true,
      key: ['p'],
      run: () => void brush.toggle()
    },
    {
      group: 'Work',
      keys: '[ / ]',
      does: 'a smaller or a larger brush',
      single: true,
      key: ['['],
      run: () => brush.resize(1 / 1.2)
    },
    {
      group: 'Work',
      keys: 'Esc',
      does: 'end a comparison or painting',
      key: ['Escape'],
      run: () => {
        if (brush.isOn)
          brush.close();
        else if (compare.mode !== 'off')
          compare.setMode('off');
        else
          return false;
      }
    },
    {
      group: 'Work',
      keys: '?',
      does: 'these keys',
      single: true,
      key: ['?'],
      run: () => document.getElementById('help')?.click()
    },
    ...unlisted([
      {code: ['Numpad3'], run: () => orbit.from(90, 0)},
      {code: ['Numpad7'], run: () => orbit.from(0, 90)},
      {single: true, key: ['-', '−'], run: () => view.step(-1)},
      {ctrl: true, shift: false, isUndo: true, key: ['y'], run: () => step(false)},
      {single: true, key: [']'], run: () => brush.resize(1.2)},
    ]),
  ];
}

/** @returns {string} what is shown now */
function shownNow() {
  const select = document.getElementById('show');
  return select instanceof HTMLSelectElement ? select.value : 'picture';
}

/**
 * Keys that another row of the help names.
 * @param {Partial<import('./shortcuts.js').Shortcut>[]} rows
 */
function unlisted(rows) {
  return rows.map((row) => ({group: '', keys: '', does: '', ...row}));
}
