// How the run went: hypervolume and feasible share by generation, failures, the table of designs.

const hypervolumeUnit = objectives.map((objective) => objective.unit).join(" · ");

const drawProgress = () => {
  const known = content.generations;
  const x = known.map((generation) => generation.evaluations);
  const across = plotAxis("evaluations", { range: [0, 1.03 * x.at(-1)], zeroline: false });
  const line = (values, hover) => ({
    type: "scatter", mode: known.length > 40 ? "lines" : "lines+markers", x, y: values, text: hover, hoverinfo: "text",
    line: { color: colour("accent"), width: 2, shape: "linear" }, marker: { size: 5, color: colour("accent") },
  });
  const config = { ...plotConfig, displayModeBar: false };
  const hypervolumes = known.map((generation) => generation.hypervolume);
  const after = (generation) => `after ${generation.evaluations} evaluations`;
  if (known.at(-1).reference) Plotly.react(byId("hypervolume"),
    [line(hypervolumes, known.map((one) => `${figure(one.hypervolume)} ${plain(hypervolumeUnit)}<br>${after(one)}`))],
    plotLayout({ xaxis: across, yaxis: plotAxis("", { rangemode: "tozero", zeroline: false, exponentformat: "power" }), margin: { l: 52, r: 8, t: 10, b: 42 } }), config);
  Plotly.react(byId("share"),
    [{ ...line(known.map((one) => 100 * one.feasible_share), known.map((one) => `${percent(one.feasible_share)}<br>${after(one)}`)), fill: "tozeroy", fillcolor: colour("accent-wash") }],
    plotLayout({ xaxis: across, yaxis: plotAxis("", { range: [0, 104], zeroline: false, ticksuffix: "" }), margin: { l: 40, r: 8, t: 10, b: 42 } }), config);
};

const startProgress = () => {
  const known = content.generations;
  const last = known.at(-1);
  byId("hypervolume-caption").textContent = `Hypervolume [${hypervolumeUnit}]`;
  if (!last) {
    const pair = byId("hypervolume").closest(".pair");
    pair.replaceWith(element("p", { class: "plain", text: "No generation is complete yet." }));
    return;
  }
  if (last.reference) {
    const corner = Object.entries(last.reference).map(([name, value]) => `${words(name)} ${withUnit(value, objectives.find((one) => one.name === name)?.unit ?? "1")}`);
    byId("hypervolume").setAttribute("aria-label", `Hypervolume after ${last.evaluations} evaluations: ${figure(last.hypervolume)}`);
    byId("hypervolume").closest("section").append(element("p", { class: "hint", text: `Hypervolume against the reference ${corner.join(", ")}; it only grows, and only runs against the same reference compare.` }));
  }
  if (!last.reference) byId("hypervolume").replaceWith(element("p", { class: "plain", id: "hypervolume", text: "None before the first feasible design." }));
  drawProgress();
  on("theme", drawProgress);
};

const startFailures = () => {
  const place = byId("failures");
  if (content.failures.length === 0) {
    place.append(element("p", { class: "plain", text: content.facts.evaluations ? "Every evaluated design is feasible." : "No evaluation yet." }));
    return;
  }
  const most = content.failures[0].count;
  const body = content.failures.map((failure) => element("tr", {},
    element("th", { scope: "row", class: "cause", text: capital(failure.cause) }),
    element("td", { class: "number", text: `${failure.count}` }),
    element("td", { style: "width:30%" }, element("div", { class: "bar", style: `width:${(100 * failure.count) / most}%`, "aria-hidden": "true" })),
    element("td", { class: "number", text: percent(failure.count / content.facts.evaluations) }),
    element("td", { text: `Design ${failure.example}: ${failure.reason}` })));
  const heads = [["Cause", ""], ["Designs", "number"], ["", ""], ["of all", "number"], ["First example", ""]];
  place.append(element("table", {},
    element("thead", {}, element("tr", {}, ...heads.map(([text, kind]) => element("th", { scope: "col", class: kind, text })))),
    element("tbody", {}, ...body)));
};

const TABLE_ROWS = 300;
const sorting = { axis: 0, rising: true };

const drawTable = () => {
  const wanted = (hasFront ? frontRows : lineRows()).filter(inside);
  const column = sorting.axis === null ? points.number : axes[sorting.axis].column;
  const order = [...wanted].sort((a, b) => (sorting.rising ? 1 : -1) * ((column[a] ?? Infinity) - (column[b] ?? Infinity)));
  const shown = order.slice(0, TABLE_ROWS);
  const note = shown.length < order.length ? `, the first ${shown.length} of ${order.length} in this order` : "";
  byId("table-hint").textContent = wanted.length ? `${hasFront ? "Designs of the front" : "Designs"}${filtered() ? " inside the brushes" : ""}${note}. A column's name sorts by it.` : "No design to list.";
  const sort = (axis) => () => {
    sorting.rising = sorting.axis === axis ? !sorting.rising : true;
    sorting.axis = axis;
    drawTable();
  };
  const head = (text, axis) => {
    const sorted = sorting.axis === axis ? (sorting.rising ? "ascending" : "descending") : null;
    const arrow = sorted ? (sorting.rising ? " ▴" : " ▾") : "";
    return element("th", { scope: "col", class: "number", "aria-sort": sorted }, element("button", { type: "button", text: text + arrow, onclick: sort(axis) }));
  };
  const columns = axes.slice(0, objectives.length);
  const cells = (row) => columns.map((axis) => element("td", { class: "number", text: exact(axis.column[row]) }));
  const extra = hasFront ? [] : [element("th", { scope: "col", class: "number", text: "Violation [m]" })];
  const body = shown.map((row) => {
    const number = points.number[row];
    return element("tr", { "aria-current": number === state.selected ? "true" : null, onclick: () => select(number) },
      element("td", { class: "number" }, element("button", { type: "button", class: "open", text: `${number}`, "aria-label": `Show design ${number}` })),
      ...cells(row),
      ...(hasFront ? [] : [element("td", { class: "number", text: figure(points.violation_m[row]) })]),
      element("td", { text: marksOf(number).map((mark) => mark.label).join(", ") }));
  });
  const table = element("table", {},
    element("thead", {}, element("tr", {}, head("Design", null), ...columns.map((axis, index) => head(label(axis), index)), ...extra, element("th", { scope: "col", text: "Worth a look" }))),
    element("tbody", {}, ...body));
  byId("table").hidden = wanted.length === 0;
  byId("table").replaceChildren(table);
};

const markTableRow = () => {
  for (const row of byId("table").querySelectorAll("tbody tr")) {
    const current = row.querySelector(".open").textContent === String(state.selected);
    if (current) row.setAttribute("aria-current", "true");
    else row.removeAttribute("aria-current");
  }
};

const startTable = () => {
  drawTable();
  on("filter", drawTable);
  on("selected", markTableRow);
};
