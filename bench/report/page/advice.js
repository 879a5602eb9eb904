// The advice: the cheapest configuration that meets the tolerance on every stated metric; ../advice.py says the same.
"use strict";
const METRICS = { error: "error", error_max: "worst error", error_p99: "99 % quantile", error_mean: "mean error", bias: "bias" };

/// What a metric is called; the error by what the task, or the query set, means by it.
const metricName = (m, r) => (m === "error" ? errorName(r.task, r.set).replace(/ \(.*/, "") : METRICS[m]);

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
    for (const m in METRICS) if (r[m] !== null && Math.abs(r[m]) > allowed) return { set: r.set, name: metricName(m, r), figure: Math.abs(r[m]) };
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
  const largest = new Map(); // sets may mean different things by their error
  for (const m in METRICS)
    for (const r of rung.rows.filter((r) => r[m] !== null && !(m === "error_mean" && r[m] === r.error))) { // no news
      const name = metricName(m, r), value = Math.abs(r[m]) <= (r.floor || 0) ? 0 : Math.abs(r[m]);
      largest.set(name, Math.max(value, largest.get(name) || 0));
    }
  const parts = [...largest], coarse = Math.max(...rung.rows.map((r) => r.floor || 0));
  if (parts.every(([, v]) => v === 0)) {
    if (coarse > COARSE) return `as right as the truth can tell, which is itself off by ${figure(coarse)}`;
    return rung.rows.every((r) => r.promise) ? "exact on every stated metric" : "exact on this sample alone, as nothing is promised for others";
  }
  const none = coarse > COARSE ? `below the truth's own ${figure(coarse)}` : "exact";
  return parts.map(([name, v]) => `${name} ${v === 0 ? none : figure(v)}`).join(", ");
}

const rungName = (r) => r.method + ([r.build, r.query].filter(Boolean).length ? ` (${[r.build, r.query].filter(Boolean).join("; ")})` : "");
const limitText = (limit, tolerance) => {
  const [is, allowed] = limit.figure === null ? [] : tolerance === 0 ? [figure(limit.figure), "exact"] : toldApart(limit.figure, tolerance);
  return (limit.figure === null ? limit.name : `${limit.name} ${is}, above ${allowed}`) + ` (${limit.set})`;
};

/// Lowest and highest cost that the repetitions leave, or null.
function intervalOf(rung) {
  if (rung.rows.some((r) => r.lo === null || r.hi === null || r.lo === r.hi)) return null;
  const sum = (name) => rung.rows.reduce((all, r) => all + r[name], 0);
  return [sum("lo"), sum("hi")];
}
function asFast(a, b) {
  const [x, y] = [intervalOf(a), intervalOf(b)];
  return x !== null && y !== null && x[0] <= y[1] && y[0] <= x[1];
}

/// Largest error over the sets, for the order where nothing holds: what has none, or broke, comes last.
const errorOf = (rung) =>
  rung.rows.some((r) => r.error === null || r.status !== "ok") ? Infinity : Math.max(...rung.rows.map((r) => Math.abs(r.error)));

/// Other rungs that hold in a time that cannot be told from the chosen one's; those that promise as much first.
const MOST_TIES = 4;
function tiesText(best, ties) {
  const promised = (rung) => rung.rows.every((r) => r.promise);
  const order = [...ties.filter(promised), ...ties.filter((r) => !promised(r))];
  const named = order.slice(0, MOST_TIES).map((r) => `${rungName(r)} at ${duration(r.cost)}, ${errorsText(r)}`).join("; or ");
  const more = order.length > MOST_TIES ? `; and ${order.length - MOST_TIES} more` : "";
  return `The lead of ${rungName(best)} is within the intervals of the repetitions: as fast may be ${named}${more}.`;
}

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
  const at = ladder.findIndex((r) => limitOf(r, tolerance) === null), best = ladder[at];
  const ties = at < 0 ? [] : ladder.slice(at + 1).filter((r) => limitOf(r, tolerance) === null && asFast(best, r));
  const out = box.querySelector(".answer");
  if (at < 0) {
    out.innerHTML = ladder.length
      ? `<p class="take">No configuration that was measured here meets ${words}. The most accurate:</p>` : '<p class="take">Nothing was measured here.</p>';
  } else {
    const below = ladder[at - 1];
    const cost = sets.length > 1 ? ` for one ${model.tasks[task].queryWord} of each of the ${sets.length} sets` : ` per ${model.tasks[task].queryWord}`;
    out.innerHTML =
      `<p class="take">Take <b>${escapeHtml(rungName(best))}</b>: ${duration(best.cost)}${cost}; ${errorsText(best)}.</p>` +
      `<p class="below">` + (below
        ? `The rung below, ${escapeHtml(rungName(below))} at ${duration(below.cost)}, breaks: ${escapeHtml(limitText(limitOf(below, tolerance), tolerance))}.`
        : "There is no rung below: this is the cheapest that was measured.") + "</p>" +
      (ties.length ? `<p class="below ties">${escapeHtml(tiesText(best, ties))}</p>` : "");
  }
  const near = at < 0 ? [...ladder].sort((a, b) => errorOf(a) - errorOf(b) || 0).slice(0, 8) : ladder.slice(Math.max(0, at - 4), at + 4);
  box.querySelector(".rungs").innerHTML = near.map((r) => {
    const limit = limitOf(r, tolerance);
    const mark = r === best ? ' class="taken"' : limit ? ' class="broken"' : "";
    return `<tr${mark}><td>${limit ? "✗" : "✓"}</td><td>${escapeHtml(rungName(r))}</td><td>${duration(r.cost)}</td>` +
      `<td>${limit ? escapeHtml(limitText(limit, tolerance)) : r === best ? "the cheapest that holds" : ties.includes(r) ? "holds, and may be as fast" : "holds, but costs more"}</td></tr>`;
  }).join("");
}
