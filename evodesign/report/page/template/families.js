// Families: the best design of every kind as a map, and the nearest relatives of the chosen design.

const kinds = content.families.kinds.filter((kind) => rowOf.has(kind.design));
const descriptors = content.families.descriptors;
const MOST_RELATIVES = 6;

// The column of a quantity among the page's points, if it is there.
const columnOf = (name) =>
  ({ lowest_reach: points.lowest_m, highest_reach: points.highest_m })[name] ??
  points.objectives[name] ??
  points.constraints[name] ??
  points.parameters[name];

// Where a design lies on the map, in cells; null where a quantity does not exist.
const cellsOf = (row) => {
  const places = descriptors.map(({ name, lower, upper, cells }) => {
    const values = name.split(" + ").map((part) => columnOf(part)?.[row] ?? null);
    if (values.includes(null)) return null;
    const sum = values.reduce((total, value) => total + value, 0);
    return ((sum - lower) / (upper - lower)) * cells;
  });
  return places.includes(null) ? null : places;
};

// A sentence where the ring of a design cannot stand where the design lies.
const besideTheMap = (row) => {
  const place = cellsOf(row);
  if (!place) return `Design ${points.number[row]} is not on the map: it lacks a quantity that tells kinds apart.`;
  const beyond = descriptors.filter(({ cells }, index) => place[index] < -1e-9 || place[index] > cells + 1e-9);
  if (!beyond.length) return "";
  const names = beyond.map(({ name, lower, upper }) => `${words(name)} (${figure(lower)} to ${figure(upper)})`);
  return `Design ${points.number[row]} lies outside the map in ${names.join(" and ")}; its ring is at the edge.`;
};

// The elites of other cells, the nearest first.
const relativesOf = (row) => {
  const place = cellsOf(row);
  if (!place) return [];
  const own = place.map((value, axis) =>
    Math.min(Math.max(Math.floor(value), 0), descriptors[axis].cells - 1),
  );
  const apart = (kind) => Math.hypot(...place.map((value, axis) => kind.cell[axis] + 0.5 - value));
  return kinds
    .filter((kind) => kind.design !== points.number[row] && kind.cell.some((one, axis) => one !== own[axis]))
    .sort((a, b) => apart(a) - apart(b))
    .slice(0, MOST_RELATIVES);
};

const drawFamilies = () => {
  const { objective: name } = content.families;
  const objective = objectives.find((one) => one.name === name);
  const sign = objective.sense === "maximise" ? -1 : 1;
  const [across, up = { name: "", lower: 0, upper: 1, cells: 1 }] = descriptors;
  const centres = ({ lower, upper, cells }) =>
    Array.from({ length: cells }, (_, place) => lower + ((place + 0.5) / cells) * (upper - lower));
  const best = Array.from({ length: up.cells }, () => Array(across.cells).fill(null));
  for (const kind of kinds) {
    const [x, y = 0] = kind.cell;
    const before = best[y][x];
    if (!before || sign * kind.objectives[name] < sign * before.objectives[name]) best[y][x] = kind;
  }
  const told = (kind) =>
    [
      `<b>Design ${kind.design}</b>`,
      ...kind.descriptors.map((value, axis) => `${plain(words(descriptors[axis].name))} ${exact(value)}`),
      ...objectives
        .filter((one) => one.name in kind.objectives)
        .map((one) => `${plain(words(one.name))} ${exact(kind.objectives[one.name])} ${plain(unitText(one.unit))}`),
    ].join("<br>");
  const values = kinds.map((kind) => kind.objectives[name]);
  const ends = [quantile(values, sign > 0 ? 0 : 0.05), quantile(values, sign > 0 ? 0.95 : 1)];
  const beyond = values.filter((value) => value < ends[0] || value > ends[1]).length;
  const remarks = [
    beyond ? `Beyond the scale of colours: ${beyond} designs.` : "",
    rowOf.has(state.selected) ? besideTheMap(rowOf.get(state.selected)) : "",
  ];
  byId("families-beyond").textContent = remarks.filter(Boolean).join(" ");
  const scale = strength();
  const chosen = rowOf.has(state.selected) ? cellsOf(rowOf.get(state.selected)) : null;
  const at = (axis, value) =>
    axis.lower + (Math.min(axis.cells, Math.max(0, value)) / axis.cells) * (axis.upper - axis.lower);
  Plotly.react(
    byId("families"),
    [
      {
        type: "heatmap",
        x: centres(across),
        y: centres(up),
        z: best.map((line) => line.map((kind) => kind && kind.objectives[name])),
        customdata: best.map((line) => line.map((kind) => kind && kind.design)),
        text: best.map((line) => line.map((kind) => (kind ? told(kind) : ""))),
        hoverinfo: "text",
        hoverongaps: false,
        xgap: 1,
        ygap: 1,
        zmin: ends[0],
        zmax: ends[1],
        colorscale: sign > 0 ? scale.map(([share], place) => [share, scale[1 - place][1]]) : scale,
        colorbar: { thickness: 12, outlinewidth: 0, title: { text: plain(label(objective)), side: "right" } },
      },
      ...(chosen
        ? [
            {
              type: "scatter",
              mode: "markers",
              x: [at(across, chosen[0])],
              y: [at(up, chosen[1] ?? 0.5)],
              hoverinfo: "skip",
              cliponaxis: false,
              marker: { size: 12, color: "rgba(0,0,0,0)", line: { color: colour("second"), width: 3 } },
            },
          ]
        : []),
    ],
    plotLayout({
      xaxis: plotAxis(words(across.name), { zeroline: false, showgrid: false, range: [across.lower, across.upper] }),
      yaxis: plotAxis(words(up.name), {
        ...{ zeroline: false, showgrid: false, range: [up.lower, up.upper] },
        ...(descriptors.length < 2 ? { showticklabels: false, ticks: "" } : {}),
      }),
    }),
    plotConfig,
  );
};

const drawRelatives = () => {
  const row = rowOf.get(state.selected);
  const found = row === undefined ? [] : relativesOf(row);
  const { objective: name } = content.families;
  const unit = unitText(objectives.find((one) => one.name === name).unit);
  byId("relatives").replaceChildren(
    ...(found.length
      ? [
          element("span", { class: "hint", text: `Nearest relatives of design ${state.selected} of other builds:` }),
          ...found.map((kind) =>
            element(
              "button",
              { type: "button", class: "chip", "data-relative": kind.design, onclick: () => pick(kind.design) },
              `${kind.design}`,
              element("small", { text: `${exact(kind.objectives[name], 3)} ${unit}` }),
            ),
          ),
        ]
      : []),
  );
};

const startFamilies = () => {
  const { objective, filled, cells } = content.families;
  if (!kinds.length) {
    byId("families").replaceWith(
      element("p", { class: "plain", text: "No feasible design has the quantities that tell kinds apart." }),
    );
    return;
  }
  byId("families-hint").textContent =
    `The design of best ${words(objective)} of every kind: ${filled} of ${cells} cells are filled. A click shows its robot. ` +
    `Other kinds: evodesign families RUN --by NAME --by NAME.`;
  let begun = false;
  const draw = () => {
    if (!byId("families-section").open) return;
    drawFamilies();
    drawRelatives();
    if (begun) return;
    begun = true;
    byId("families").on("plotly_click", ({ points: [point] }) => {
      if (point.customdata === null || point.customdata === undefined) return;
      document.activeElement.blur(); // so that arrow keys walk on
      pick(point.customdata);
    });
  };
  byId("families-section").addEventListener("toggle", draw);
  for (const event of ["theme", "selected"]) on(event, draw);
};
