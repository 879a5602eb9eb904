// Draws the charts, one after the other so that the page stays alive, and feeds them anew when the choice changes.
"use strict";
const drawn = new Map(); // chart id → Vega view
const tip = document.getElementById("tip");

function tipHtml(r) {
  const element = model.tasks[r.task].element;
  const knobs = [r.build && "built with " + r.build, r.query && "asked with " + r.query].filter(Boolean).join("; ");
  const line = (name, value) => (value === "–" || value === "" ? "" : `<tr><th>${name}</th><td>${escapeHtml(value)}</td></tr>`);
  const exact = r.error !== null && Math.abs(r.error) <= (r.floor || 0);
  return (
    `<b>${escapeHtml(r.method)}</b> <i>${r.source}${r.version ? " " + escapeHtml(r.version) : ""}, claims ${r.claim}</i>` +
    (knobs ? `<p>${escapeHtml(knobs)}</p>` : "") +
    (r.status === "ok" ? "" : `<p class="bad">${r.status.replace(/_/g, " ")}${r.reason ? ": " + escapeHtml(r.reason) : ""}</p>`) +
    "<table>" +
    line("time", r.ns === null ? "–" : duration(r.ns) + (r.lo === null ? "" : ` (${duration(r.lo)} to ${duration(r.hi)}` + (r.reps ? `, ${r.reps} repetitions)` : ")"))) +
    line("CPU time", duration(r.cpu)) +
    line("error", r.error === null ? "–" : figure(r.error) + (!exact ? "" : r.floor > COARSE ? " (as right as the truth can tell)" : r.promise ? " (exact)" : " (exact on this sample alone)")) +
    line("worst", figure(r.error_max)) + line("99 % below", figure(r.error_p99)) + line("mean", figure(r.error_mean)) +
    line("bias", figure(r.bias)) + line("recall", share(r.recall)) + line("truth's floor", figure(r.floor)) +
    line("also", r.extra) +
    line("build", r.build_s === null ? "–" : duration(r.build_s * 1e9) + ` (${figure((r.build_s * 1e9) / r.n)} ns per ${element})`) +
    line("bytes", r.bytes === null ? "–" : figure(r.bytes) + ` (${figure(r.bytes / r.n)} per ${element})` +
      (r.kept ? `, beside ${figure(r.kept)} of the user's that must stay (${figure((r.bytes + r.kept) / r.n)} in all)` : "")) +
    line("work", r.nodes === null && r.primitives === null ? "–" :
      `${figure(r.nodes)} nodes, ${r.leaves === null ? "" : figure(r.leaves) + " leaves, "}${figure(r.primitives)} ${element}s per query`) +
    line("on", `${r.dataset}, ${several(r.n, element)}` + (r.set ? ", " + r.set : "") + (r.threads ? `, ${r.threads} thread${r.threads > 1 ? "s" : ""}` : "")) +
    "</table>"
  );
}

function showTip(html, x, y) {
  tip.innerHTML = html;
  tip.hidden = false;
  const box = tip.getBoundingClientRect();
  tip.style.left = Math.max(4, Math.min(x + 14, innerWidth - box.width - 8)) + "px";
  tip.style.top = Math.max(4, y + 16 + box.height > innerHeight ? y - box.height - 12 : y + 16) + "px";
}

function onPoint(_, event, item, value) {
  if (!value || !item || !item.datum) tip.hidden = true;
  else if (item.datum.i !== undefined) showTip(tipHtml(rows[item.datum.i]), event.clientX, event.clientY);
  else if (typeof value === "object") // a chart that brings its own data and says what to tell of it
    showTip("<table>" + Object.entries(value).map(([k, v]) => `<tr><th>${escapeHtml(k)}</th><td>${escapeHtml(v)}</td></tr>`).join("") + "</table>", event.clientX, event.clientY);
  else tip.hidden = true;
}

function label(chart, list) {
  if (chart.kind === "fixed") return `${chart.task}, ${chart.title}`;
  const c = choice(chart.task);
  const words = { frontier: "error against time per query", build: "build time", bytes: "bytes", scaling: "time per query against size" };
  return `${words[chart.kind]}, ${chart.dataset}${c.set ? ", " + shownSet(chart.task, chart.dataset, c) : ""}: ${list.length} points; the figures are in the table below the charts`;
}

function refresh(chart) {
  const view = drawn.get(chart.id);
  if (!view || chart.kind === "fixed") return null;
  const box = document.getElementById(chart.id);
  const list = chartRows[chart.kind](chart.task, chart.dataset, choice(chart.task));
  box.classList.toggle("none", list.length === 0);
  box.setAttribute("aria-label", label(chart, list));
  return view.data("points", pointsOf(chart, list)).runAsync();
}

/// The points of a chart; of the frontier with a note in each lane that has none, and the title of its axis.
function pointsOf(chart, list) {
  if (!chart.lanes) return list.map(point);
  const c = choice(chart.task), axis = errorName(chart.task, shownSet(chart.task, chart.dataset, c));
  return [...list.map(point), ...laneNotes(chart.lanes, chosen(chart.task, chart.dataset, c)), { axis, y: chart.middle }];
}

async function draw(chart) {
  const box = document.getElementById(chart.id);
  const fixed = chart.kind === "fixed"; // brings its own data
  const list = fixed ? [] : chartRows[chart.kind](chart.task, chart.dataset, choice(chart.task));
  const spec = fixed ? chart.spec : { ...chart.spec, datasets: { ...chart.spec.datasets, points: pointsOf(chart, list) } };
  const { view } = await vegaEmbed(box, spec, { renderer: "svg", actions: false, tooltip: onPoint });
  drawn.set(chart.id, view);
  box.setAttribute("role", "img");
  box.setAttribute("aria-label", label(chart, list));
  box.classList.toggle("none", !fixed && list.length === 0);
  box.dataset.marks = String(box.querySelectorAll(".mark-symbol path").length);
  const save = document.createElement("a");
  save.textContent = "SVG";
  save.className = "save";
  save.href = "#";
  save.title = "Save this chart as SVG";
  save.addEventListener("click", async (e) => {
    e.preventDefault();
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([await view.toSVG()], { type: "image/svg+xml" }));
    link.download = chart.id + ".svg";
    link.click();
  });
  box.after(save);
}

async function drawAll() {
  const root = document.documentElement.dataset;
  root.expected = String(model.charts.length);
  for (const chart of model.charts) {
    try {
      await draw(chart);
    } catch (e) {
      reportError_(chart.id + ": " + e.message);
    }
    root.drawn = String(drawn.size);
    await new Promise((next) => setTimeout(next, 0));
  }
  root.ready = "yes";
}

function refreshTask(task) {
  for (const chart of model.charts) if (chart.task === task) refresh(chart);
  for (const card of document.querySelectorAll(`.card[data-task="${task}"]`)) updateCard(card);
}

/// Heading, what was not measured, and the table of figures.
function updateCard(card) {
  const { task, dataset } = card.dataset;
  const c = choice(task), list = chosen(task, dataset, c), set = shownSet(task, dataset, c);
  const element = model.tasks[task].element;
  const other = set === c.set ? "" : `; ${set}, as ${c.set} is not asked here`;
  card.querySelector(".size").textContent = list.length
    ? several(list[0].n, element) + other : "not measured at this size";
  const absent = list.filter((r) => r.status === "unsupported" || r.status === "not_built");
  const tried = new Set(list.filter((r) => !absent.includes(r)).map((r) => r.method));
  const texts = firstOf(absent, (r) => r.method).map((r) => {
    const count = absent.filter((other) => other.method === r.method).length;
    const some = tried.has(r.method) ? `${count} configuration${count > 1 ? "s" : ""} of ` : ""; // others of it were measured
    return `${some}${r.method} (${r.status.replace("_", " ")}${r.reason ? ": " + r.reason : ""})`;
  });
  card.querySelector(".absent").textContent = texts.length ? "Not measured here: " + texts.join("; ") + "." : "";
  const details = card.querySelector("details.all");
  if (details.open) fillTable(details, list);
  else details.querySelector(".figures").textContent = "";
}

function fillTable(details, list) {
  const heads = ["method", "knobs", "status", "time", "interval", "error", "worst", "bias", "recall", "build", "bytes", "with kept input", "nodes", "leaves"];
  const body = [...list].sort((a, b) => (a.ns ?? Infinity) - (b.ns ?? Infinity)).map((r) => [
    (r.front ? "★ " : "") + r.method, [r.build, r.query].filter(Boolean).join("; "), r.status.replace(/_/g, " "), duration(r.ns),
    r.lo === null ? "–" : `${duration(r.lo)}…${duration(r.hi)}`, figure(r.error), figure(r.error_max), figure(r.bias), share(r.recall),
    r.build_s === null ? "–" : duration(r.build_s * 1e9), figure(r.bytes), r.kept === null || r.bytes === null ? "–" : figure(r.bytes + r.kept), figure(r.nodes), figure(r.leaves),
  ]);
  const cells = (tag, list) => "<tr>" + list.map((v) => `<${tag}>${escapeHtml(v)}</${tag}>`).join("") + "</tr>";
  details.querySelector(".figures").innerHTML =
    `<table class="plain"><thead>${cells("th", heads)}</thead><tbody>${body.map((b) => cells("td", b)).join("")}</tbody></table>`;
}
