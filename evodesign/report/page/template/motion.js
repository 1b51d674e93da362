// The lift that is shown, over its time: torques of the joints, power, forces on the hands. Its moments are those
// that the page holds, joined by straight lines.

const MOST_LINES = 8;

const momentsOf = (design, at) => {
  const own = everyStop.filter((stop) => taskTexts[stop] === taskTexts[at.stop]);
  const postures = own.map((stop) => postureAt(design, { ...at, stop }));
  return { times: own.map((stop) => stops[stop].time_s), postures };
};

// The joints with the largest torques on the way: their torques [N m] at every moment.
const torqueLines = (postures, agent) => {
  const torques = postures.map((posture) => posture.agents[agent].torques_n_m);
  const most = (joint) => Math.max(...torques.map((one) => Math.abs(one[joint])));
  const joints = Object.keys(torques[0]).sort((a, b) => most(b) - most(a));
  return joints.slice(0, MOST_LINES).map((joint) => [joint, torques.map((one) => one[joint])]);
};

// Torque times speed [W]: of all joints, and of those that drive.
const powerLines = (postures, agent) => {
  const powers = postures.map(({ agents }) =>
    Object.entries(agents[agent].speeds_rad_s ?? {}).map(
      ([joint, speed]) => speed * agents[agent].torques_n_m[joint],
    ),
  );
  const sum = (values) => values.reduce((whole, one) => whole + one, 0);
  return [
    ["all joints", powers.map(sum)],
    ["joints that drive", powers.map((one) => sum(one.filter((power) => power > 0)))],
  ];
};

// Size of the force on each hand [N].
const handLines = (postures, agent) =>
  ["left", "right"].map((side) => [
    `${side} hand`,
    postures.map(({ agents }) => Math.hypot(...agents[agent].hand_wrenches[side].slice(0, 3))),
  ]);

const drawOverTime = (place, times, lines, title) => {
  const ink = (index) => mixedColour("accent", "second", lines.length > 1 ? index / (lines.length - 1) : 0);
  const traces = lines.map(([name, values], index) => ({
    type: "scatter",
    mode: "lines+markers",
    name: plain(name),
    x: times,
    y: values,
    line: { color: ink(index), width: 1.6, dash: ["solid", "dot", "dash", "dashdot"][index % 4] },
    marker: { size: 4 },
  }));
  place.drawn = Plotly.react(
    place,
    traces,
    plotLayout({
      height: 210 + 16 * Math.ceil(lines.length / 3),
      showlegend: true,
      legend: { orientation: "h", x: 0, y: 1.02, yanchor: "bottom", font: plotFont() },
      margin: { l: 46, r: 6, t: 30, b: 38 },
      xaxis: plotAxis("time [s]"),
      yaxis: plotAxis(title, { zeroline: true, zerolinecolor: colour("faint") }),
    }),
    { ...plotConfig, displayModeBar: false },
  );
};

// Nothing where no load moves.
const motionSection = (design) => {
  if (!everyStop.some(isLift)) return null;
  let whose = "robot";
  const kinds = [
    ["torque [N m]", torqueLines],
    ["power [W]", powerLines],
    ["force on a hand [N]", handLines],
  ];
  const plots = kinds.map(([title]) =>
    element("div", { class: "joint-plot", role: "img", "aria-label": `${capital(title)} over the time of the lift` }),
  );
  const section = element(
    "details",
    { open: true, id: "over-time" },
    element("summary", { text: "Lift over time" }),
    element("div", { class: "choices", style: "margin-top:10px" }, agentSegments("over-time", (agent) => draw(agent))),
    element("p", { class: "hint", text: `The ${MOST_LINES} joints with the largest torques, power of the joints, forces on the hands.` }),
    ...plots,
  );
  const draw = (agent = whose) => {
    whose = agent;
    const at = shownCase();
    const { times, postures } = momentsOf(design, at);
    section.hidden = !isLift(at.stop) || !postures.every(Boolean);
    if (section.hidden) return;
    kinds.forEach(([title, lines], place) => drawOverTime(plots[place], times, lines(postures, agent), title));
  };
  return { section, draw };
};
