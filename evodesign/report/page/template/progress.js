// How the run went: hypervolume and feasible share by generation.

const hypervolumeUnit = objectives.map((objective) => objective.unit).join(" · ");

const drawProgress = () => {
  const known = content.generations;
  const x = known.map((generation) => generation.evaluations);
  const across = plotAxis("evaluations", { range: [0, 1.03 * x.at(-1)], zeroline: false });
  const line = (values, hover) => ({
    type: "scatter",
    mode: known.length > 40 ? "lines" : "lines+markers",
    x,
    y: values,
    text: hover,
    hoverinfo: "text",
    line: { color: colour("accent"), width: 2, shape: "linear" },
    marker: { size: 5, color: colour("accent") },
  });
  const config = { ...plotConfig, displayModeBar: false };
  const hypervolumes = known.map((generation) => generation.hypervolume);
  const after = (generation) => `after ${generation.evaluations} evaluations`;
  if (known.at(-1).reference)
    Plotly.react(
      byId("hypervolume"),
      [
        line(
          hypervolumes,
          known.map((one) => `${figure(one.hypervolume)} ${plain(hypervolumeUnit)}<br>${after(one)}`),
        ),
      ],
      plotLayout({
        xaxis: across,
        yaxis: plotAxis("", { rangemode: "tozero", zeroline: false, exponentformat: "power" }),
        margin: { l: 52, r: 8, t: 10, b: 42 },
      }),
      config,
    );
  Plotly.react(
    byId("share"),
    [
      {
        ...line(
          known.map((one) => 100 * one.feasible_share),
          known.map((one) => `${percent(one.feasible_share)}<br>${after(one)}`),
        ),
        fill: "tozeroy",
        fillcolor: colour("accent-wash"),
      },
    ],
    plotLayout({
      xaxis: across,
      yaxis: plotAxis("", { range: [0, 104], zeroline: false, ticksuffix: "" }),
      margin: { l: 40, r: 8, t: 10, b: 42 },
    }),
    config,
  );
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
    const corner = Object.entries(last.reference).map(
      ([name, value]) =>
        `${words(name)} ${withUnit(value, objectives.find((one) => one.name === name)?.unit ?? "1")}`,
    );
    byId("hypervolume").setAttribute(
      "aria-label",
      `Hypervolume after ${last.evaluations} evaluations: ${figure(last.hypervolume)}`,
    );
    byId("hypervolume")
      .closest("section")
      .append(
        element("p", {
          class: "hint",
          text: `Hypervolume against the reference ${corner.join(", ")}; it only grows, and only runs against the same reference compare.${content.growth ? ` ${capital(content.growth)}.` : ""}`,
        }),
      );
  }
  if (!last.reference)
    byId("hypervolume").replaceWith(
      element("p", { class: "plain", id: "hypervolume", text: "None before the first feasible design." }),
    );
  drawProgress();
  on("theme", drawProgress);
};
