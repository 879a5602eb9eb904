// The rows, made whole again from the compact table, and the choice of what is shown.
"use strict";
/// A truth that is itself off by more is no rounding: what agrees with it is not exact for that (../frontier.py).
const COARSE = 1e-5;
const model = JSON.parse(document.getElementById("model").textContent);
const rows = model.table.rows.map((line, i) => {
  const row = { i };
  model.table.columns.forEach((name, c) => {
    row[name] = c < model.table.text_columns ? model.table.strings[line[c]] : line[c];
  });
  return row;
});
const byDataset = new Map();
for (const row of rows) {
  if (row.set.endsWith("_threads")) continue; // thread scaling has a chart of its own
  const key = row.task + "/" + row.dataset;
  if (!byDataset.has(key)) byDataset.set(key, []);
  byDataset.get(key).push(row);
}
const rowsOf = (task, dataset) => byDataset.get(task + "/" + dataset) || [];

/// "1 direction", "20,000 triangles".
const several = (n, word) => `${n.toLocaleString("en")} ${word}${n === 1 ? "" : "s"}`;

/// What the reader chose for a task: query set, size ("largest" or a number), run, threads.
function choice(task) {
  const value = (name) => {
    const input = document.getElementById(task + "-" + name);
    return input ? input.value : null;
  };
  const number = (name, first) => (value(name) === null ? first : Number(value(name)));
  const t = model.tasks[task];
  return {
    set: value("set"),
    size: value("size") === "largest" || value("size") === null ? null : Number(value("size")),
    run: number("run", t.runs[0]),
    threads: number("threads", t.threads[0]),
  };
}

/// The query set that a dataset shows under a choice: the chosen one, or, where it was asked no such set, its first.
function shownSet(task, dataset, c) {
  const sets = rowsOf(task, dataset).map((r) => r.set);
  return sets.includes(c.set) ? c.set : sets.find((s) => s !== "") ?? c.set;
}

/// What the error of a query set is.
const errorName = (task, set) => model.tasks[task].errors[set] ?? model.tasks[task].error;

/// Rows of a dataset under a choice; `sizes` keeps every size.
function chosen(task, dataset, c, sizes = false, sets = false) {
  const mine = rowsOf(task, dataset).filter((r) => r.run === c.run && (r.threads === c.threads || r.threads === null));
  const size = c.size === null ? Math.max(...mine.map((r) => r.size)) : c.size;
  const set = shownSet(task, dataset, c);
  return mine.filter((r) => (sizes || r.size === size) && (sets || r.set === set || r.set === ""));
}

function point(r) {
  const resolution = /\bresolution (\d+)/.exec(r.build || "");
  return {
    i: r.i, method: r.method, x: r.ns,
    lo: r.lo === null ? r.ns : r.lo, hi: r.hi === null ? r.ns : r.hi,
    y: r.y, front: !!r.front, promise: !!r.promise, coarse: r.floor > COARSE, best: !!r.best, slot: r.slot, n: r.n,
    cells: resolution ? Number(resolution[1]) : null, asked: r.query,
    build: r.built === null ? null : Math.max(r.built, model.table.least),
    bytes: r.bytes === null || !r.n ? null : Math.max((r.bytes + (r.kept || 0)) / r.n, model.table.least),
    own: r.bytes === null || !r.n ? null : Math.max(r.bytes / r.n, model.table.least),
  };
}

/// Why a lane of the exact band is empty; ../layout.py says the same.
function laneNotes(lanes, list) {
  const drawn = (r) => r.status === "ok" && r.ns !== null && r.error !== null;
  const exact = new Set(list.filter((r) => drawn(r) && Math.abs(r.error) <= (r.floor || 0)).map((r) => r.method));
  return Object.entries(lanes).filter(([method]) => !exact.has(method)).map(([method, y]) => {
    const mine = list.filter((r) => r.method === method), absent = (r) => r.status === "unsupported" || r.status === "not_built";
    const failed = mine.find((r) => r.status !== "ok" && !absent(r)), missing = mine.find(absent);
    const reason = missing ? missing.reason || missing.status.replace(/_/g, " ") : "not measured here";
    const note = mine.some(drawn) ? "not without error here"
      : mine.some((r) => r.status === "ok" && r.ns !== null) ? "timed alone: nothing to judge here"
      : failed ? failed.status.replace(/_/g, " ") + " here"
      : reason.length <= model.table.note_most ? reason : "not offered here (reason below)";
    return { method, y, note };
  });
}

function firstOf(list, key) {
  const seen = new Map();
  for (const item of list) if (!seen.has(key(item))) seen.set(key(item), item);
  return [...seen.values()];
}

/// The points that one kind of chart shows; a fixed one brings its own.
const chartRows = {
  fixed: () => [],
  frontier: (task, dataset, c) => chosen(task, dataset, c).filter((r) => r.y !== null),
  build: (task, dataset, c) =>
    firstOf(chosen(task, dataset, c, false, true).filter((r) => r.built !== null), (r) => r.method + "|" + r.build),
  bytes: (task, dataset, c) =>
    firstOf(chosen(task, dataset, c, false, true).filter((r) => r.bytes !== null), (r) => r.method + "|" + r.build),
  scaling: (task, dataset, c) => chosen(task, dataset, c, true).filter((r) => r.best),
};

/// A share of 1, never rounded up to it: 0.99998 is not all.
const share = (v) => (v === null || v === undefined ? "–" : v === 1 ? "1" : String(Math.floor(v * 1e4) / 1e4));
const figure = (v) => {
  if (v === null || v === undefined) return "–";
  if (v === 0) return "0";
  const a = Math.abs(v);
  if (a >= 1e-3 && a < 1e5) return a < 1000 ? String(Number(v.toPrecision(3))) : Math.round(v).toLocaleString("en");
  return v.toExponential(1).replace("e+", "e").replace(".0e", "e");
};
/// Two figures that are not the same, with as many digits as tell them apart.
const toldApart = (a, b) => {
  const enough = (v, digits) => {
    const small = Math.abs(v) < 1e-3 || Math.abs(v) >= 1e5;
    return small ? v.toExponential(digits - 1).replace("e+", "e") : String(Number(v.toPrecision(digits)));
  };
  let texts = [figure(a), figure(b)];
  for (let digits = 3; texts[0] === texts[1] && digits < 17; ++digits) texts = [enough(a, digits), enough(b, digits)];
  return texts;
};
const duration = (ns) => {
  if (ns === null) return "–";
  for (const [unit, scale] of [["s", 1e9], ["ms", 1e6], ["µs", 1e3]]) if (ns >= scale) return figure(ns / scale) + " " + unit;
  return figure(ns) + " ns";
};
const escapeHtml = (s) => String(s).replace(/[&<>"']/g, (c) => "&#" + c.charCodeAt(0) + ";");
