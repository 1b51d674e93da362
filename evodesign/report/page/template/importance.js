// What matters: each parameter's share of an objective's variance, and slices through the chosen design.

const shownImportance = { objective: 0 };

const tenths = (share) => (100 * share).toFixed(1);
const interval = ({ value, low, high }) => `${tenths(value)} % (${tenths(low)} to ${tenths(high)})`;

// A bar for the total share with the part that the parameter explains alone, and a line for the interval.
const shareBar = ({ first, total }) =>
  element(
    "div",
    { class: "meter", "aria-hidden": "true" },
    element("b", { style: `width:${100 * Math.min(1, total.value)}%` }),
    element("b", { class: "alone", style: `width:${100 * Math.min(1, first.value)}%` }),
    element("i", {
      class: "interval",
      style: `left:${100 * Math.min(1, total.low)}%;right:${100 * Math.max(0, 1 - total.high)}%`,
    }),
  );

// One slice: the band and mean of what is predicted, and the design's own value; all slices share the scale.
const sliceOf = (slice, [low, high], value, measured) => {
  const [left, right] = [slice.values[0], slice.values.at(-1)];
  const across = (x) => 4 + (124 * (x - left)) / (right - left || 1);
  const up = (y) => 27 - (24 * (Math.min(high, Math.max(low, y)) - low)) / (high - low || 1);
  const path = (column) => slice.values.map((x, place) => `${across(x)},${up(column[place])}`);
  const ends = `From ${figure(slice.predicted[0])} at ${figure(left)} to ${figure(slice.predicted.at(-1))} at ${figure(right)}`;
  const here = measured === null ? "" : `<circle class="here" cx="${across(value)}" cy="${up(measured)}" r="3"/>`;
  const box = element("div");
  box.innerHTML = `<svg class="slice" viewBox="0 0 132 30" role="img" aria-label="${ends}">
    <polygon class="band" points="${[...path(slice.low), ...path(slice.high).reverse()].join(" ")}"/>
    <polyline class="mean" points="${path(slice.predicted).join(" ")}"/>${here}</svg>`;
  return box;
};

const slicesOf = (objective) => {
  const slices = content.designs[state.selected]?.slices ?? [];
  return new Map(slices.filter((one) => one.objective === objective).map((one) => [one.parameter, one]));
};

const drawImportance = () => {
  const found = content.importance.objectives[shownImportance.objective];
  const modelled = found.parameters.some((one) => one.total);
  const sloped = found.parameters.some((one) => one.slope);
  const slices = slicesOf(found.name);
  const row = rowOf.get(state.selected);
  const measured = row === undefined ? null : points.objectives[found.name][row];
  const span = [...slices.values()].flatMap((one) => [...one.predicted, ...(measured === null ? [] : [measured])]);
  const scale = [Math.min(...span), Math.max(...span)];
  byId("importance-hint").textContent = modelled
    ? `Shares of the variance over all designs within the bounds: the whole bar is what a parameter explains alone and together with others, its inner part what it explains alone; the line spans 5 to 95 % of the models' samples. ${
        slices.size
          ? `Curves: ${words(found.name)} along each parameter of design ${state.selected}, from lower to upper bound, all in one scale.`
          : "Curves are drawn through marked designs."
      }`
    : "";
  const heads = [
    ["Parameter", ""],
    ...(modelled
      ? [
          ["", "aside"],
          ["in all", "number loose"],
          ["alone", "number aside"],
        ]
      : []),
    ...(sloped ? [[`Slope [${unitText(found.unit)}]`, modelled ? "number aside" : "number"]] : []),
    ...(slices.size ? [[`Through ${state.selected}`, ""]] : []),
  ];
  const body = found.parameters.map((one) => {
    const cells = [element("th", { scope: "row", text: one.name })];
    if (modelled)
      cells.push(
        element("td", { class: "aside" }, shareBar(one)),
        element("td", { class: "number loose", text: interval(one.total) }),
        element("td", { class: "number aside", text: `${tenths(one.first.value)} %` }),
      );
    if (sloped) {
      const slope = one.slope && (one.slope.value < 1e-12 ? "0" : exact(one.slope.value, 3));
      cells.push(element("td", { class: modelled ? "number aside" : "number", text: slope ?? "–" }));
    }
    if (slices.size)
      cells.push(
        element(
          "td",
          {},
          sliceOf(
            slices.get(one.name),
            scale,
            points.parameters[one.name][row],
            points.objectives[found.name][row],
          ),
        ),
      );
    return element("tr", { "data-matters": one.name }, ...cells);
  });
  const place = byId("importance");
  place.hidden = !modelled && !sloped;
  place.replaceChildren(
    element(
      "table",
      { class: "importance" },
      element(
        "thead",
        {},
        element("tr", {}, ...heads.map(([text, kind]) => element("th", { scope: "col", class: kind, text }))),
      ),
      element("tbody", {}, ...body),
    ),
  );
  const pairs = found.pairs
    .slice(0, 3)
    .map((pair) => `${pair.names.join(" with ")} ${interval(pair.share)}`);
  const remarks = [
    ...(pairs.length ? [`Strongest interactions: ${pairs.join(", ")}`] : []),
    ...content.importance.sentences,
  ];
  byId("importance-remarks").replaceChildren(...remarks.map((text) => element("li", { text })));
};

const startImportance = () => {
  if (objectives.length > 1)
    byId("importance-choices").append(
      element(
        "label",
        {},
        "Objective ",
        element(
          "select",
          {
            id: "importance-objective",
            onchange: (event) => {
              shownImportance.objective = Number(event.target.value);
              drawImportance();
            },
          },
          ...objectives.map((one, index) => element("option", { value: index, text: words(one.name) })),
        ),
      ),
    );
  drawImportance();
  on("selected", drawImportance);
};
