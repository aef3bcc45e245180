// Style sheet and script of the trade-off's page.
#include "measure/tradeoff/parts.h"

namespace scumble::internal {

const char* const kTradePageStyle = R"(
body { max-width: 100rem; }
.choose { display: flex; flex-wrap: wrap; gap: .3rem 1.6rem; margin: .6rem 0; }
.choose fieldset { border: 0; padding: 0; margin: 0; display: flex; flex-wrap: wrap; gap: .1rem .9rem; }
.choose legend { float: left; color: var(--soft); padding: 0 .9rem 0 0; }
.choose label { white-space: nowrap; cursor: pointer; } svg.mark { width: 14px; height: 14px; vertical-align: -2px; }
.plot { display: none; } .plot.first { display: block; }
svg.chart { width: 100%; max-width: 76rem; display: block; font: 12px system-ui, sans-serif; }
svg text { fill: var(--soft); } svg text.name { fill: var(--text); } svg .grid { stroke: var(--line); }
svg .front { stroke: var(--text); fill: none; stroke-width: 1.6; stroke-dasharray: 6 3; }
svg .ring { stroke: var(--text); fill: none; stroke-width: 1.6; }
svg .bar { stroke: var(--soft); stroke-width: .8; } svg .name, svg > .bar { pointer-events: none; }
svg a.point:hover path, svg a.point:focus path { stroke: var(--text); stroke-width: 2; }
#told { white-space: pre-line; min-height: 7.5em; }
#variants th, #variants td { padding-right: .9rem; } #variants tbody th { color: var(--text); white-space: nowrap; }
#variants thead button { font: inherit; color: inherit; background: none; border: 0; padding: 0; cursor: pointer;
  text-align: inherit; }
#variants th[aria-sort=ascending] button::after { content: " ▲"; }
#variants th[aria-sort=descending] button::after { content: " ▼"; }
tr.chosen > * { background: color-mix(in srgb, var(--good) 14%, transparent); } .star { color: var(--good); }
.variants { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(30rem, 100%), 1fr)); gap: 1.4rem; }
figure { margin: 0; } img { height: auto; }
figure.variant:target { outline: 3px solid var(--good); outline-offset: 6px; }
figure.variant img { cursor: zoom-in; }
dialog { width: 100vw; max-width: none; height: 100vh; max-height: none; margin: 0; padding: .8rem 1.2rem; border: 0;
  box-sizing: border-box; color: var(--text); background: var(--ground); }
dialog .bar { display: flex; justify-content: space-between; gap: 1rem; flex-wrap: wrap; }
dialog button { font: inherit; color: inherit; background: var(--card); border: 1px solid var(--line);
  border-radius: 4px; cursor: pointer; }
dialog button[aria-pressed=true] { border-color: var(--text); }
.stage { display: flex; gap: .8rem; overflow: auto; margin: .6rem 0; cursor: pointer; } .stage figure { flex: none; }
.stage img { width: auto; max-width: none; } .stage.flip figure:not(.on) { display: none; }
@media print {
  :root { color-scheme: light; --text: #000; --soft: #444; --ground: #fff; --card: #fff; --line: #ccc;
    --good: #1f7a4a; }
  body { margin: 0; max-width: none; font-size: 9pt; } .choose, dialog { display: none; }
  section { border: 0; padding: 0; overflow: visible; }
  @page { size: landscape; } #variants, #variants th { font-size: 6pt; }
  #variants th, #variants td { padding: 1pt .6em 1pt 0; }
  #variants thead th { white-space: normal; }
  #told { min-height: 0; } svg.chart { max-width: 20cm; }
  .variants { grid-template-columns: 1fr 1fr; } figure.variant, tr { break-inside: avoid; }
}
)";

const char* const kTradePageScript = R"(
"use strict";
(() => {
  const byId = id => document.getElementById(id);
  const told = byId("told"), table = byId("variants"), flip = byId("flip");
  if (!told) return;

  // The text for the point under the pointer or the focus shows below the chart.
  const atFirst = told.textContent;
  const tell = event => {
    const point = event.target.closest && event.target.closest("a.point");
    told.textContent = point ? point.querySelector("title").textContent : atFirst;
  };
  byId("chart").addEventListener("pointerover", tell);
  byId("chart").addEventListener("focusin", tell);

  // Columns sort; empty cells stay last.
  const valueOf = cell => "v" in cell.dataset ? cell.dataset.v : cell.textContent;
  const sortBy = (column, descending) => {
    const rows = [...table.tBodies[0].rows];
    const number = table.tHead.rows[0].cells[column].classList.contains("number") || column === 0;
    rows.sort((a, b) => {
      const [x, y] = [a, b].map(row => valueOf(row.cells[column]));
      if (x === "" || y === "") return (x === "") - (y === "");
      return (number ? x - y : x.localeCompare(y, undefined, {numeric: true})) * (descending ? -1 : 1);
    });
    table.tBodies[0].append(...rows);
  };
  [...table.tHead.rows[0].cells].forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const descending = head.getAttribute("aria-sort") === "ascending";
      for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", descending ? "descending" : "ascending");
      sortBy(column, descending);
    });
  });

  // Two pictures at full size, to flip between.
  const variants = [...document.querySelectorAll("figure.variant")];
  const own = variants.find(variant => variant.classList.contains("chosen"));
  const pictureOf = variant => variant.querySelector("img") ||
    (variant.dataset.same ? byId("variant-" + variant.dataset.same).querySelector("img") : null);
  const nameOf = variant => variant.querySelector("figcaption b").textContent;
  const stage = byId("flip-stage");
  let at = 0;
  const sideBySide = on => {
    stage.classList.toggle("flip", !on);
    byId("flip-side").setAttribute("aria-pressed", on);
  };
  const say = variant => {
    byId("flip-name").textContent = nameOf(variant);
    byId("flip-words").textContent = variant.querySelector("figcaption").innerText.split("\n").slice(1).join(" · ");
  };
  const turn = () => {
    if (stage.children.length < 2) return;
    if (!stage.classList.contains("flip")) return sideBySide(false);
    for (const shown of stage.children) shown.classList.toggle("on");
    say(stage.querySelector(".on").variant);
  };
  const show = index => {
    at = (index + variants.length) % variants.length;
    const variant = variants[at];
    say(variant);
    stage.replaceChildren(...(own && own !== variant ? [variant, own] : [variant]).filter(pictureOf).map((shown, i) => {
      const figure = document.createElement("figure"), image = new Image();
      const caption = document.createElement("figcaption");
      image.src = pictureOf(shown).src;
      image.alt = nameOf(shown);
      caption.textContent = nameOf(shown);
      figure.variant = shown;
      figure.append(image, caption);
      figure.classList.toggle("on", i === 0);
      return figure;
    }));
    if (!flip.open) flip.showModal();
  };
  document.addEventListener("click", event => {
    if (event.ctrlKey || event.metaKey || event.shiftKey) return;
    const link = event.target.closest("a[href^='#variant-']"), image = event.target.closest("figure.variant img");
    const variant = link ? document.querySelector(link.getAttribute("href"))
                         : image ? image.closest("figure.variant") : null;
    if (!variant || !pictureOf(variant)) return;
    event.preventDefault();
    show(variants.indexOf(variant));
  });
  stage.addEventListener("click", turn);
  byId("flip-side").addEventListener("click", () => sideBySide(stage.classList.contains("flip")));
  byId("flip-before").addEventListener("click", () => show(at - 1));
  byId("flip-next").addEventListener("click", () => show(at + 1));
  byId("flip-close").addEventListener("click", () => flip.close());
  flip.addEventListener("keydown", event => {
    const action = {ArrowLeft: turn, ArrowRight: turn, ArrowUp: () => show(at - 1), ArrowDown: () => show(at + 1),
                    s: () => sideBySide(stage.classList.contains("flip"))}[event.key];
    if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    action();
  });
})();
)";

}  // namespace scumble::internal
