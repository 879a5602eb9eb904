// Wires the page: selectors, legend, winners, matrix, contents, theme.
"use strict";
const all = (selector, root = document) => [...root.querySelectorAll(selector)];

for (const bar of all(".choices")) {
  bar.addEventListener("change", () => {
    refreshTask(bar.dataset.task);
    all(`.advice[data-task="${bar.dataset.task}"]`).forEach(updateAdvice);
  });
}
for (const card of all(".card")) {
  updateCard(card);
  card.querySelector("details.all").addEventListener("toggle", () => updateCard(card));
}
for (const box of all(".advice")) {
  box.addEventListener("input", () => updateAdvice(box));
  startAdvice(box);
  updateAdvice(box);
}

// The legend: pointing at a method shows it alone, a click keeps it so.
for (const legend of all(".legend")) {
  const task = legend.dataset.task;
  let kept = "";
  const pick = (method) => {
    for (const chart of model.charts)
      if (chart.task === task && drawn.has(chart.id) && (chart.spec.params || []).some((p) => p.name === "pick"))
        drawn.get(chart.id).signal("pick", method).runAsync();
  };
  for (const chip of all("button", legend)) {
    chip.addEventListener("mouseenter", () => pick(chip.dataset.method));
    chip.addEventListener("mouseleave", () => pick(kept));
    chip.addEventListener("click", () => {
      kept = kept === chip.dataset.method ? "" : chip.dataset.method;
      all("button", legend).forEach((b) => b.setAttribute("aria-pressed", String(b.dataset.method === kept)));
      pick(kept);
    });
  }
}

// A winner's cell leads to its chart, with its query set chosen.
for (const link of all("a[data-set]")) {
  link.addEventListener("click", () => {
    const select = document.getElementById(link.dataset.task + "-set");
    if (!select || select.value === link.dataset.set) return;
    select.value = link.dataset.set;
    select.dispatchEvent(new Event("change", { bubbles: true }));
  });
}

// The matrix: one tab stop, arrow keys move, the line below says what a cell means.
for (const table of all("table.matrix")) {
  const line = document.getElementById(table.id + "-line");
  const cells = all("td[data-detail]", table);
  const show = (cell) => (line.textContent = cell.dataset.detail);
  if (cells.length) cells[0].tabIndex = 0;
  table.addEventListener("focusin", (e) => e.target.dataset.detail && show(e.target));
  table.addEventListener("mouseover", (e) => {
    const cell = e.target.closest("td[data-detail]");
    if (cell) show(cell);
  });
  table.addEventListener("keydown", (e) => {
    const cell = e.target.closest("td");
    if (!cell) return;
    const row = cell.parentElement;
    const rowsHere = [...row.parentElement.rows];
    const step = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] }[e.key];
    if (!step) return;
    const next = (rowsHere[rowsHere.indexOf(row) + step[0]] || row).cells[cell.cellIndex + step[1]];
    e.preventDefault();
    if (!next || next.tagName !== "TD") return;
    cell.tabIndex = -1;
    next.tabIndex = 0;
    next.focus();
  });
}

// A picture opens in full on a click.
for (const picture of all("figure img")) {
  picture.addEventListener("click", () => picture.closest("figure").classList.toggle("large"));
}

document.getElementById("theme").addEventListener("click", () => {
  const root = document.documentElement;
  const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  root.dataset.theme = dark ? "light" : "dark";
});

// The contents follow the reader.
const links = new Map(all("#contents a").map((a) => [a.getAttribute("href").slice(1), a]));
const seen = new IntersectionObserver((entries) => {
  for (const e of entries) {
    if (!e.isIntersecting) continue;
    links.forEach((a) => a.removeAttribute("aria-current"));
    links.get(e.target.id)?.setAttribute("aria-current", "true");
  }
}, { rootMargin: "-20% 0px -70% 0px" });
links.forEach((_, id) => document.getElementById(id) && seen.observe(document.getElementById(id)));
document.addEventListener("scroll", () => (tip.hidden = true), { passive: true });
document.addEventListener("keydown", (e) => e.key === "Escape" && (tip.hidden = true));

drawAll();
