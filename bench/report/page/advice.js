// The advice: the cheapest configuration that meets the tolerance on every stated metric; ../advice.py says the same.
"use strict";
const METRICS = { error: "mean error", error_max: "worst error", error_p99: "99 % quantile", error_mean: "mean of all answers", bias: "bias" };

/// Slider position 0 is exact; then ten steps a decade from 1e-12 to 1.
const toleranceAt = (position) => (position === 0 ? 0 : Number(Math.pow(10, -12 + (position - 1) / 10).toPrecision(3)));

function rungs(list, sets) {
  const found = new Map();
  for (const r of list) {
    if (!sets.includes(r.set) || r.ns === null) continue;
    const key = [r.method, r.build, r.query].join("|");
    if (!found.has(key)) found.set(key, { method: r.method, build: r.build, query: r.query, cells: new Map() });
    found.get(key).cells.set(r.set, r);
  }
  const ladder = [];
  for (const rung of found.values()) {
    const cells = [...rung.cells.values()];
    if (cells.length < sets.length) continue;
    rung.rows = sets.map((s) => rung.cells.get(s));
    rung.cost = rung.rows.reduce((sum, r) => sum + r.ns, 0);
    ladder.push(rung);
  }
  return ladder.sort((a, b) => a.cost - b.cost);
}

/// The first limit that a rung breaks, or null.
function limitOf(rung, tolerance) {
  for (const r of rung.rows) {
    if (r.status !== "ok") return { set: r.set, name: r.status.replace(/_/g, " "), figure: null };
    const allowed = Math.max(tolerance, r.floor || 0);
    for (const m in METRICS) if (r[m] !== null && Math.abs(r[m]) > allowed) return { set: r.set, name: METRICS[m], figure: Math.abs(r[m]) };
    if (r.error === null) return { set: r.set, name: "nothing tells how far off its answers are", figure: null };
  }
  // Down there a promise is asked for, and a sample without errors is none.
  for (const r of rung.rows)
    if (!r.promise && tolerance <= (r.floor || 0))
      return { set: r.set, name: `its claim is ${r.claim}: no error seen here promises none elsewhere`, figure: null };
  return null;
}

/// The largest of each stated error over the query sets, in words.
function errorsText(rung) {
  const parts = [];
  for (const m in METRICS) {
    const values = rung.rows.filter((r) => r[m] !== null).map((r) => (Math.abs(r[m]) <= (r.floor || 0) ? 0 : Math.abs(r[m])));
    if (values.length) parts.push([METRICS[m], Math.max(...values)]);
  }
  if (parts.every(([, v]) => v === 0))
    return rung.rows.every((r) => r.promise) ? "exact on every stated metric" : "approximate; exact on this sample";
  return parts.map(([name, v]) => `${name} ${v === 0 ? "exact" : figure(v)}`).join(", ");
}

const rungName = (r) => r.method + ([r.build, r.query].filter(Boolean).length ? ` (${[r.build, r.query].filter(Boolean).join("; ")})` : "");
const limitText = (limit, tolerance) =>
  (limit.figure === null ? limit.name : `${limit.name} ${figure(limit.figure)}, above ${tolerance === 0 ? "exact" : figure(tolerance)}`) + ` (${limit.set})`;

// The query sets on which --advise measures; of older rows, which do not say, those that every method answers.
function askedSets(rows) {
  const timed = rows.filter((r) => r.ns !== null);
  const told = [...new Set(timed.filter((r) => r.advised).map((r) => r.set))];
  if (told.length) return told;
  const methods = [...new Set(timed.map((r) => r.method))], sets = [...new Set(timed.map((r) => r.set))];
  const shared = sets.filter((s) => methods.every((m) => timed.some((r) => r.method === m && r.set === s)));
  return shared.length ? shared : sets;
}

/// The rungs of what the reader chose, and the sets that they were asked.
function ladderOf(box) {
  const get = (name) => box.querySelector(`[name="${name}"]`).value;
  const list = chosen(box.dataset.task, get("dataset"), choice(box.dataset.task), false, true);
  const sets = get("set") === "*" ? askedSets(list) : [get("set")];
  return { ladder: rungs(list, sets), sets };
}

/// Puts the slider where something holds, if nothing does where it stands: the least such tolerance.
function startAdvice(box) {
  const slider = box.querySelector('[name="tolerance"]'), { ladder } = ladderOf(box);
  const holds = (position) => ladder.some((r) => limitOf(r, toleranceAt(position)) === null);
  let position = Number(slider.value);
  while (position < Number(slider.max) && !holds(position)) ++position;
  if (holds(position)) slider.value = position;
}

function updateAdvice(box) {
  const task = box.dataset.task;
  const get = (name) => box.querySelector(`[name="${name}"]`);
  const tolerance = toleranceAt(Number(get("tolerance").value));
  const words = tolerance === 0 ? "exact" : figure(tolerance);
  get("tolerance").setAttribute("aria-valuetext", words);
  box.querySelector(".value").textContent = words;
  const { ladder, sets } = ladderOf(box);
  const at = ladder.findIndex((r) => limitOf(r, tolerance) === null);
  const out = box.querySelector(".answer");
  if (at < 0) {
    out.innerHTML = ladder.length
      ? `<p class="take">No configuration that was measured here meets ${words}.</p>` : '<p class="take">Nothing was measured here.</p>';
  } else {
    const best = ladder[at], below = ladder[at - 1];
    const cost = sets.length > 1 ? ` for one ${model.tasks[task].queryWord} of each of the ${sets.length} sets` : ` per ${model.tasks[task].queryWord}`;
    out.innerHTML =
      `<p class="take">Take <b>${escapeHtml(rungName(best))}</b>: ${duration(best.cost)}${cost}; ${errorsText(best)}.</p>` +
      `<p class="below">` + (below
        ? `The rung below, ${escapeHtml(rungName(below))} at ${duration(below.cost)}, breaks: ${escapeHtml(limitText(limitOf(below, tolerance), tolerance))}.`
        : "There is no rung below: this is the cheapest that was measured.") + "</p>";
  }
  const near = ladder.slice(Math.max(0, at - 4), (at < 0 ? ladder.length : at) + 4).slice(0, 8);
  box.querySelector(".rungs").innerHTML = near.map((r) => {
    const limit = limitOf(r, tolerance);
    const mark = r === ladder[at] ? ' class="taken"' : limit ? ' class="broken"' : "";
    return `<tr${mark}><td>${limit ? "✗" : "✓"}</td><td>${escapeHtml(rungName(r))}</td><td>${duration(r.cost)}</td>` +
      `<td>${limit ? escapeHtml(limitText(limit, tolerance)) : r === ladder[at] ? "the cheapest that holds" : "holds, but costs more"}</td></tr>`;
  }).join("");
}
