// The front, in two or three of its objectives, constrained quantities or parameters. With one objective: its
// value over the evaluations. `everything` counts how often
// it was asked that the axes reach to the last design.

const NO_COLOUR = -1;
const drawnIn = { across: 0, up: 1, colour: NO_COLOUR, solid: false, everything: 0 };

// How much the front's designs differ in an objective: interquartile range over the median's size.
const spread = (axis) => {
  const values = frontRows.map((row) => axis.column[row]);
  const middle = quantile(values, 0.5);
  return (quantile(values, 0.75) - quantile(values, 0.25)) / (Math.abs(middle) || 1);
};

const evaluationAxis = { name: "evaluation", unit: "number", sense: "", column: points.number };
const frontAxes = objectives.length > 1 ? axes : [evaluationAxis, ...axes];

// The third axis: what colours, and in three dimensions always one.
const thirdIndex = () => {
  if (drawnIn.colour !== NO_COLOUR || !drawnIn.solid) return drawnIn.colour;
  return frontAxes.findIndex((_, index) => index !== drawnIn.across && index !== drawnIn.up);
};

// Beyond this number SVG is slow; all traces then change to WebGL together, so that they keep their order.
const manyPoints = frontRows.length + dominatedRows.length > 2500 && hasWebgl;

const hover = (row) => {
  const lines = [`<b>Design ${points.number[row]}</b>`];
  for (const mark of marksOf(points.number[row])) lines.push(plain(mark.label));
  const drawn = [drawnIn.across, drawnIn.up, thirdIndex()].map((index) => frontAxes[index]);
  for (const axis of [...resultAxes, ...drawn.filter((one) => one?.isParameter)]) {
    lines.push(`${plain(words(axis.name))} ${exact(axis.column[row])} ${plain(unitText(axis.unit))}`);
  }
  return lines.join("<br>");
};

const frontTrace = (wanted, name, marker, more = {}) => {
  const { across, up, solid } = drawnIn;
  const column = (index) => wanted.map((row) => frontAxes[index].column[row]);
  return {
    type: solid ? "scatter3d" : manyPoints ? "scattergl" : "scatter",
    mode: "markers",
    name,
    x: column(across),
    y: column(up),
    ...(solid ? { z: column(thirdIndex()) } : {}),
    text: wanted.map(hover),
    customdata: wanted.map((row) => points.number[row]),
    hoverinfo: "text",
    unselected: { marker: { opacity: 1 } },
    marker,
    ...more,
  };
};

// All of the front with the marked designs, and what lies behind it once that is asked for. What lies outside is
// counted below the figure.
const zoomed = (axis) => {
  const behind = drawnIn.everything || axis.isParameter ? dominatedRows : [];
  const marked = content.marks.map((mark) => rowOf.get(mark.number));
  const values = [...frontRows, ...marked, ...behind].map((row) => axis.column[row]).filter((value) => value !== null);
  const low = values.reduce((a, b) => Math.min(a, b), Infinity);
  const high = values.reduce((a, b) => Math.max(a, b), -Infinity);
  const margin = 0.05 * (high - low) || Math.abs(high) * 0.05 || 1;
  return [low - margin, high + margin];
};

const colourScale = (axis) => {
  const [low, high] = zoomed(axis);
  return {
    colorscale: strength(),
    reversescale: axis.sense === "minimise",
    cmin: low,
    cmax: high,
    showscale: !narrow.matches,
    colorbar: {
      title: { text: plain(label(axis)), side: "right" },
      thickness: 10,
      outlinewidth: 0,
      len: 0.9,
      tickfont: plotFont(),
      ticklen: 3,
      tickcolor: colour("faint"),
    },
  };
};

const MARK_TRACES = ["knee", "best", "gain", "asked", "unscaled"];

const markTraces = () => {
  const shapes = drawnIn.solid
    ? { unscaled: "cross", best: "diamond", gain: "diamond", knee: "square", asked: "circle" }
    : { unscaled: "star", best: "diamond-open", gain: "cross-open", knee: "square-open", asked: "triangle-up-open" };
  return MARK_TRACES.flatMap((kind) => {
    const marked = content.marks.filter((mark) => mark.kind === kind).map((mark) => rowOf.get(mark.number));
    const drawn = marked.filter(complete);
    if (drawn.length === 0) return [];
    const size = drawnIn.solid ? (kind === "unscaled" ? 9 : 5) : kind === "unscaled" ? 15 : 14;
    const line = {
      width: drawnIn.solid ? 0 : kind === "unscaled" ? 1 : 2,
      color: kind === "unscaled" ? colour("surface") : colour("second"),
    };
    return [frontTrace(drawn, kind, { size, symbol: shapes[kind], color: colour("second"), line })];
  });
};

const frontTraces = () => {
  const { solid } = drawnIn;
  const third = drawnIn.colour !== NO_COLOUR && !solid ? frontAxes[drawnIn.colour] : null;
  const kept = frontRows.filter(inside);
  const left = frontRows.filter((row) => !inside(row));
  const around = dominatedRows.filter((row) => !filtered() || inside(row));
  const size = solid ? 4 : 9;
  const chosen =
    state.selected !== null && rowOf.has(state.selected) ? [rowOf.get(state.selected)].filter(complete) : [];
  const tint = third
    ? { color: kept.map((row) => third.column[row]), ...colourScale(third) }
    : { color: colour("accent") };
  const traces = [
    frontTrace(around, "dominated", {
      size: solid ? 1.8 : 4,
      color: colour("faint"),
      opacity: solid ? 0.5 : 0.6,
    }),
    frontTrace(left, "left out", { size: size - 3, color: colour("faint"), opacity: 0.5 }),
    frontTrace(kept, "front", { size, ...tint, line: { width: solid ? 0 : 0.8, color: colour("accent") } }),
    ...markTraces(),
  ];
  const ring = solid
    ? { size: 11, symbol: "circle-open", color: colour("ink"), line: { width: 3, color: colour("ink") } }
    : { size: 19, symbol: "circle-open", color: colour("ink"), line: { width: 2.2, color: colour("ink") } };
  const bars = solid ? [] : peopleBars(chosen);
  return [...traces, ...bars, frontTrace(chosen, "chosen", ring, { hoverinfo: "skip" })];
};

// Mean and standard deviation over people, of the chosen design: a cross over the quantities that spread.
const peopleBars = (chosen) => {
  const drawn = [drawnIn.across, drawnIn.up].map((index) => frontAxes[index]);
  const spreads = chosen.map((row) => drawn.map(({ name }) => overPeopleOf(points.number[row], name)));
  if (!spreads.flat().some(Boolean)) return [];
  const middle = (place) => chosen.map((row, one) => spreads[one][place]?.mean ?? drawn[place].column[row]);
  const bar = (place) => ({
    ...{ type: "data", array: spreads.map((one) => one[place]?.deviation ?? 0), visible: true },
    ...{ color: colour("second"), thickness: 1, width: 5 },
  });
  return [
    {
      ...{ type: manyPoints ? "scattergl" : "scatter", mode: "markers", name: "people", hoverinfo: "skip" },
      ...{ x: middle(0), y: middle(1), error_x: bar(0), error_y: bar(1), customdata: [] },
      marker: { size: 1, color: colour("second") },
    },
  ];
};

// NIOSH's limit of the back's compression [N] (human.back), drawn where that is an axis.
const BACK_LIMIT = 3400;

const limitLines = (across, up) =>
  [
    [across, { x0: BACK_LIMIT, x1: BACK_LIMIT, y0: 0, y1: 1, yref: "paper" }],
    [up, { y0: BACK_LIMIT, y1: BACK_LIMIT, x0: 0, x1: 1, xref: "paper" }],
  ]
    .filter(([index]) => frontAxes[index].name.endsWith("back_compression"))
    .map(([, ends]) => ({ type: "line", ...ends, line: { color: colour("second"), width: 1.5, dash: "dot" } }));

const frontLayout = () => {
  const { across, up, solid, everything } = drawnIn;
  const third = thirdIndex();
  if (solid) {
    const axis = (index) => ({
      ...plotAxis(label(frontAxes[index])),
      range: zoomed(frontAxes[index]),
      backgroundcolor: colour("surface"),
      showbackground: false,
      title: { text: plain(label(frontAxes[index])), font: plotFont() },
    });
    return plotLayout({
      margin: { l: 0, r: 0, t: 0, b: 0 },
      uirevision: `3d ${across} ${up} ${third} ${everything}`,
      scene: {
        xaxis: axis(across),
        yaxis: axis(up),
        zaxis: axis(third),
        aspectmode: "manual",
        aspectratio: { x: 1.25, y: 1.25, z: 0.9 },
        camera: { eye: { x: 1.4, y: -1.5, z: 0.65 }, center: { x: 0, y: 0, z: -0.27 } },
      },
    });
  }
  return plotLayout({
    margin: { l: narrow.matches ? 48 : 62, r: 12, t: 30, b: 50 },
    uirevision: `2d ${across} ${up} ${everything}`,
    selections: state.lasso ? (byId("front").layout?.selections ?? []) : [],
    dragmode: "zoom",
    shapes: limitLines(across, up),
    xaxis: plotAxis(label(frontAxes[across]), { range: zoomed(frontAxes[across]), zeroline: false }),
    yaxis: plotAxis(label(frontAxes[up]), { range: zoomed(frontAxes[up]), zeroline: false }),
  });
};

const drawFront = () => {
  if (!hasFront) return;
  const config = { ...plotConfig, ...(drawnIn.solid ? {} : zoomButtons) };
  const plot = byId("front");
  const left = !state.lasso && plot.layout?.selections?.length;
  if (left) Plotly.relayout(plot, { selections: [] }); // the frame of a selection that is no more
  Plotly.react(plot, frontTraces(), frontLayout(), config);
  sayOutside();
};

// Left and right walk along the first axis.
const walk = (step) => {
  const column = frontAxes[drawnIn.across].column;
  const order = frontRows.filter(inside).sort((a, b) => column[a] - column[b]);
  if (order.length === 0) return;
  const at = order.indexOf(rowOf.get(state.selected));
  const next = at < 0 ? 0 : Math.min(Math.max(at + step, 0), order.length - 1);
  select(points.number[order[next]]);
};

const turnSolid = (solid) => {
  drawnIn.solid = solid;
  Plotly.purge(byId("front"));
  wireFront();
};

const wireFront = () => {
  drawFront();
  const plot = byId("front");
  plot.on("plotly_click", (event) => {
    plot.focus({ preventScroll: true });
    pick(pointed(event).customdata);
  });
  plot.on("plotly_hover", labelPointed);
  plot.on("plotly_relayout", sayOutside);
  plot.on("plotly_selected", (event) => {
    const drawnByHand = event?.range || event?.lassoPoints;
    if (drawnByHand) lasso(new Set(event.points.map((point) => point.customdata)));
  });
  plot.on("plotly_deselect", () => lasso(null));
};

const startFront = () => {
  const hint = byId("front-hint");
  const plot = byId("front");
  if (!hasFront) {
    hint.textContent = content.facts.evaluations
      ? "No design of this run is feasible, so there is no front yet. The designs that miss the least are below."
      : "This run holds no evaluation yet.";
    plot.hidden = true;
    return;
  }
  if (objectives.length > 2) {
    const order = objectives.map((_, index) => index).sort((a, b) => spread(axes[b]) - spread(axes[a]));
    [drawnIn.across, drawnIn.up, drawnIn.colour] = order;
  }
  const { front, feasible } = content.facts;
  const count = front === 1 ? "One design" : `${front} designs`;
  const drawn = frontRows.length < front ? ` (${frontRows.length} are drawn)` : "";
  const behind = feasible - front;
  const small = dominatedRows.length < behind ? `${dominatedRows.length} of the ${behind}` : `the ${behind}`;
  hint.textContent =
    objectives.length > 1
      ? `${count} that no other one beats in every objective${drawn}; small points are ${small} feasible designs behind. Click a point, or walk with the left and right arrow keys, to see its robot.${content.people.length > 1 ? " The cross of the chosen design spans mean ± standard deviation over people, where torques are the axes." : ""}`
      : "One objective: each point is a feasible design. Click a point to see its robot.";
  plot.setAttribute("aria-label", `${hint.textContent} The same designs are in the table below.`);
  frontChoices();
  wireFront();
  document.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    const taken = event.target.closest("input, select, canvas, pre") || event.target.matches(".scroll");
    if (!step || taken || event.altKey || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    walk(step);
  });
  for (const event of ["selected", "filter", "theme"]) on(event, drawFront);
  narrow.addEventListener("change", drawFront);
};

// Buttons for the marked designs.
const startChips = () => {
  const seen = [...new Set(content.marks.map((mark) => mark.number))];
  const chips = seen.map((number) => {
    const marks = marksOf(number);
    const chip = element(
      "button",
      { type: "button", class: "chip", "data-number": number, onclick: () => pick(number) },
      element("i", { text: symbolOf[marks[0].kind], "aria-hidden": "true" }),
      element("span", { text: [...new Set(marks.map((mark) => mark.label))].join(", ") }),
      element("small", { text: `${number}` }),
    );
    return chip;
  });
  byId("chosen").append(...chips);
  byId("chosen").hidden = chips.length === 0;
  on("selected", () =>
    chips.forEach((chip) =>
      chip.setAttribute("aria-pressed", String(chip.dataset.number === String(state.selected))),
    ),
  );
};
