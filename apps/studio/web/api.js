// The calls of api.md, and what they answer.

/**
 * @typedef {number | string | boolean} KeyValue
 * @typedef {{name: string, default: KeyValue | null, help: string, kind: string, least?: number | null,
 *   most?: number | null, unlimited?: boolean, step?: number | null, choices?: string[] | null, group: string,
 *   needs_preparing: boolean}} StyleKey
 * @typedef {{azimuth: number, elevation: number, distance: number, right: number, up: number, fov?: number}} Orbit
 * @typedef {{azimuth: number, elevation: number}} Light
 * @typedef {{name: string, style: string}} Assignment
 * @typedef {{index: number, style: number, style_id: string, file: string, width: number, height: number,
 *   luminance: number | null}} Exemplar
 * @typedef {{kind: string, message: string}} Problem
 * @typedef {{name: string, lines: number, detail: number, light: number, depth: number}} Finish
 * @typedef {{number: number, style: string, from: string, keys: Record<string, KeyValue>,
 *   before: Record<string, KeyValue>, had_frames: boolean}} Save
 * @typedef {{revision: number, scene: string, style: string,
 *   scenes: {id: string, name: string, bundled: boolean}[],
 *   styles: {id: string, name: string, bundled: boolean, writable: boolean, save_as: boolean}[],
 *   cameras: string[], objects: string[], materials: string[],
 *   animation: {first: number, last: number, fps: number, saved: number | null} | null, lights: number,
 *   exemplars: Exemplar[], run: string, as_started: boolean, first: {scene: string, style: string, options: string},
 *   keys: Record<string, KeyValue>, file_keys: Record<string, KeyValue>, key_frames: Record<string, string>,
 *   assignments: Assignment[],
 *   camera: string, view: Orbit | null, light: Light | null, finish: Finish | null,
 *   finishes: {name: string, help: string}[], eye: Orbit, frame: number | null,
 *   size: [number, number], seed: number, quality: string, budget_ms: number, problem: Problem | null,
 *   saves: Save[], warnings: string[]}} State
 * @typedef {{scene?: string, style?: string, keys?: Record<string, KeyValue | null>, assignments?: Assignment[],
 *   camera?: string, view?: Orbit | null, light?: Light | null, finish?: Finish | null,
 *   frame?: number | null, size?: [number, number],
 *   seed?: number, quality?: string, budget_ms?: number}} Changes
 * @typedef {{covered: boolean, object?: string, material?: string, style?: number, style_id?: string,
 *   exemplar?: number, source?: [number, number], level?: number, normal?: [number, number, number],
 *   luminance?: number | null, chunk?: {area: number, box: [number, number, number, number]}}} Pick
 * @typedef {{ok: boolean, why?: string, stamp?: string, file?: string, width?: number, height?: number,
 *   layer?: boolean}} Paintable
 */

/** An answer that is an error, or no answer: then `status` is 0. */
export class CallError extends Error {
  /** @param {number} status @param {string} kind @param {string} message */
  constructor(status, kind, message) {
    super(message);
    this.status = status;
    this.kind = kind;
  }
  get isGone() { return this.status === 0; }
}

/** @param {unknown} error */
export function isAbort(error) {
  return error instanceof DOMException && error.name === 'AbortError';
}

/**
 * @param {string} method
 * @param {string} path
 * @param {{json?: unknown, blob?: Blob, signal?: AbortSignal}} [options]
 * @returns {Promise<Response>}
 */
export async function call(method, path, options = {}) {
  const {json, blob, signal} = options;
  /** @type {Record<string, string>} */
  const headers = method === 'GET' ? {} : {'X-Scumble': '1', 'Content-Type': blob ? blob.type : 'application/json'};
  const body = blob ?? (json === undefined ? (method === 'GET' ? undefined : '{}') : JSON.stringify(json));
  let response;
  try {
    response = await fetch(path, {method, headers, body, signal, credentials: 'same-origin'});
  } catch (error) {
    if (isAbort(error)) throw error;
    throw new CallError(0, 'unavailable', 'The studio does not answer.');
  }
  if (response.ok) return response;
  let kind = 'unavailable', message = `${method} ${path} answered ${response.status}`;
  try {
    const answer = await response.json();
    if (answer?.error?.message) ({kind, message} = answer.error);
  } catch (error) {
    if (isAbort(error)) throw error;
  }
  throw new CallError(response.status, kind, message);
}

/**
 * @param {string} path
 * @param {Record<string, string | number>} [query]
 * @param {AbortSignal} [signal]
 */
export async function getJson(path, query = {}, signal) {
  return (await call('GET', withQuery(path, query), {signal})).json();
}

/**
 * A picture of masks or of an exemplar.
 * @param {string} path
 * @param {Record<string, string | number>} query
 * @param {AbortSignal} [signal]
 */
export async function getPicture(path, query, signal) {
  const response = await call('GET', withQuery(path, query), {signal});
  return createImageBitmap(await response.blob());
}

/** @param {string} path @param {Record<string, string | number>} query */
export function withQuery(path, query) {
  const text = new URLSearchParams(Object.entries(query).map(([name, value]) => [name, String(value)])).toString();
  return text ? `${path}?${text}` : path;
}

/**
 * Events of the server while the page can be seen: an open stream counts against the connections of a browser to one
 * host. `lost` is called when the server is gone; `found` when it is there (again), for a fresh look at the state.
 * @param {{event: (name: string, data: any) => void, lost: (error: unknown) => void, found: () => Promise<void>}} to
 * @returns {() => void} looks anew, a second later: for who finds that a call has no answer
 */
export function listen(to) {
  /** @type {EventSource | null} */
  let source = null;
  let timer = 0, wait = 500;

  async function open() {
    clearTimeout(timer);
    source?.close();
    source = null;
    if (document.hidden) return;
    try {
      await to.found();
      wait = 500;
    } catch (error) {
      retry(error);
      return;
    }
    if (source || document.hidden) return;
    const stream = source = new EventSource('/api/events');
    for (const name of ['state', 'problem', 'warnings', 'busy']) {
      stream.addEventListener(name, (event) => to.event(name, JSON.parse(/** @type {MessageEvent} */ (event).data)));
    }
    const end = () => {
      stream.close();
      if (source !== stream) return;
      source = null;
      retry(new CallError(0, 'unavailable', 'The studio does not answer.'));
    };
    stream.addEventListener('bye', end);
    stream.onerror = end;
  }

  /** @param {unknown} error */
  function retry(error) {
    to.lost(error);
    clearTimeout(timer);
    timer = setTimeout(open, wait);
    wait = Math.min(wait * 1.5, 4000);
  }

  document.addEventListener('visibilitychange', open);
  addEventListener('pagehide', () => source?.close());
  void open();
  return () => {
    clearTimeout(timer);
    timer = setTimeout(open, 1000);
  };
}
