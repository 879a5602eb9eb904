// Added by the test to a copy of the report: uses the page as a reader would, and leaves what it saw in the document.
"use strict";
(async () => {
  const root = document.documentElement;
  const pause = () => new Promise((next) => setTimeout(next, 30));
  while (root.dataset.ready !== "yes") await pause();
  const seen = { charts: {}, advice: [], changed: {}, notes: {} };
  for (const box of document.querySelectorAll(".plot")) {
    const svg = box.querySelector("svg");
    seen.charts[box.id] = {
      marks: box.querySelectorAll(".mark-symbol path").length, width: svg ? svg.getBoundingClientRect().width : 0,
      room: box.clientWidth, height: svg ? svg.getBoundingClientRect().height : 0,
    };
  }
  for (const box of document.querySelectorAll(".advice")) {
    const slider = box.querySelector("input"), dataset = box.querySelector('[name="dataset"]'), set = box.querySelector('[name="set"]');
    for (const d of dataset.options) for (const s of set.options) for (const position of [0, 61, 91, 106, 121]) {
      [dataset.value, set.value, slider.value] = [d.value, s.value, position];
      slider.dispatchEvent(new Event("input", { bubbles: true }));
      seen.advice.push({ task: box.dataset.task, dataset: d.value, set: s.value, tolerance: toleranceAt(position),
        take: box.querySelector(".take").textContent, below: (box.querySelector(".below") || {}).textContent || "" });
    }
  }
  const overflow = () => document.documentElement.scrollWidth - document.documentElement.clientWidth;
  seen.overflow = overflow();
  for (const select of document.querySelectorAll(".choices select")) {
    for (const option of select.options) {
      select.value = option.value;
      select.dispatchEvent(new Event("change", { bubbles: true }));
      await pause();
      seen.changed[select.id + "=" + option.value] =
        document.querySelectorAll(`.card[data-task="${select.id.split("-")[0]}"] .frontier .mark-symbol path`).length;
      seen.notes[select.id + "=" + option.value] = model.charts.filter((c) => c.lanes && c.task === select.id.split("-")[0])
        .flatMap((c) => drawn.get(c.id).data("points").filter((p) => p.note).map((p) => `${c.dataset} ${p.method}: ${p.note}`));
    }
  }
  const details = document.querySelector(".card details.all");
  details.open = true;
  await pause();
  seen.figures = details.querySelectorAll("tbody tr").length;
  document.querySelector(".legend button").click();
  const matrix = document.querySelector("table.matrix"), first = matrix.querySelector("td[tabindex]");
  first.focus();
  first.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight", bubbles: true }));
  await pause();
  seen.matrix = document.getElementById(matrix.id + "-line").textContent;
  seen.expectedDetail = first.nextElementSibling.dataset.detail;
  const point = document.querySelector(".frontier .mark-symbol path"), at = point.getBoundingClientRect();
  const over = { bubbles: true, clientX: at.x + at.width / 2, clientY: at.y + at.height / 2 };
  for (const type of ["pointerover", "pointermove"]) point.dispatchEvent(new PointerEvent(type, over));
  seen.tip = document.getElementById("tip").textContent;
  document.getElementById("theme").click();
  seen.theme = root.dataset.theme || "";
  const out = document.createElement("pre");
  out.id = "probe";
  out.textContent = JSON.stringify(seen);
  document.body.append(out);
})();
