// The lift that is shown, over its time: torques of the joints, as they are and as they would be at rest, power,
// forces on the hands, and where the ground pushes the soles. Its moments are those that the page holds, joined by
// straight lines.

const MOST_LINES = 8;

const LIFT_HINT = `The ${MOST_LINES} joints with the largest torques, with their limits where they have any; a thin
  line is what the torque would be at rest, with the same forces on hands and feet, so what lies between accelerates
  the body's own links. Then power of the joints, forces on the hands, and the centres of pressure under the soles,
  which begin at the large dot.`;

const momentsOf = (design, at) => {
  const own = everyStop.filter((stop) => taskTexts[stop] === taskTexts[at.stop]);
  const postures = own.map((stop) => postureAt(design, { ...at, stop }));
  const resting = design.static_torques?.[design.postures.findIndex((one) => isOf(one, at))] ?? [];
  return { times: own.map((stop) => stops[stop].time_s), postures, resting };
};

const withLimit = (joint, limit) => called(joint) + (limit === undefined ? "" : `, ±${figure(limit, 3)}`);

// The joints with the largest torques on the way: their torques [N m] at every moment, and at rest.
const torqueLines = ({ postures, resting }, agent, design) => {
  const torques = postures.map((posture) => posture.agents[agent].torques_n_m);
  const most = (joint) => Math.max(...torques.map((one) => Math.abs(one[joint])));
  const joints = Object.keys(torques[0]).sort((a, b) => most(b) - most(a));
  const limits = agentOf(agent).designed ? (design.torque_limits ?? {}) : {};
  return joints.slice(0, MOST_LINES).map((joint) => ({
    name: withLimit(joint, limits[joint]),
    values: torques.map((one) => one[joint]),
    atRest: resting.map((one) => one[agent][joint]),
  }));
};

// Torque times speed [W]: of all joints, and of those that drive.
const powerLines = ({ postures }, agent) => {
  const powers = postures.map(({ agents }) =>
    Object.entries(agents[agent].speeds_rad_s ?? {}).map(
      ([joint, speed]) => speed * agents[agent].torques_n_m[joint],
    ),
  );
  const sum = (values) => values.reduce((whole, one) => whole + one, 0);
  return [
    { name: "all joints", values: powers.map(sum) },
    { name: "joints that drive", values: powers.map((one) => sum(one.filter((power) => power > 0))) },
  ];
};

// Size of the force on each hand [N].
const handLines = ({ postures }, agent) =>
  ["left", "right"].map((side) => ({
    name: `${side} hand`,
    values: postures.map(({ agents }) => Math.hypot(...agents[agent].wrenches[`${side}_hand`].slice(0, 3))),
  }));

const drawOverTime = (place, times, lines, title) => {
  const ink = (index) => mixedColour("accent", "second", lines.length > 1 ? index / (lines.length - 1) : 0);
  const traces = lines.flatMap(({ name, values, atRest = [] }, index) => {
    const line = { color: ink(index), width: 1.6, dash: ["solid", "dot", "dash", "dashdot"][index % 4] };
    const moving = {
      type: "scatter",
      mode: "lines+markers",
      name: plain(name),
      x: times,
      y: values,
      line,
      marker: { size: 4 },
    };
    const still = {
      ...moving,
      mode: "lines",
      name: `${plain(name)}, at rest`,
      y: atRest,
      line: { ...line, width: 0.8 },
      opacity: 0.7,
      showlegend: false,
    };
    return atRest.length ? [moving, still] : [moving];
  });
  place.drawn = Plotly.react(
    place,
    traces,
    plotLayout({
      height: 210 + 16 * Math.ceil(lines.length / 3),
      showlegend: true,
      legend: { orientation: "h", x: 0, y: 1.02, yanchor: "bottom", font: plotFont() },
      margin: { l: 58, r: 6, t: 30, b: 38 },
      xaxis: plotAxis("time [s]"),
      yaxis: plotAxis(title, { zeroline: true, zerolinecolor: colour("faint") }),
    }),
    { ...plotConfig, displayModeBar: false },
  );
};

const FEET = { left: -1, right: 1 };

// Both soles from above, toes up, and the way of their centres of pressure.
const drawPressure = (place, { times, postures }, agent, person) => {
  const tree = treeOf(agent, { links: {}, joints: {} }, person);
  const [length, width] = tree.sole_size_m;
  const [long, wide] = [length / 2, width / 2];
  const traces = Object.entries(FEET).flatMap(([side, sign], index) => {
    const middle = sign * 0.75 * width;
    const centres = postures.map((posture) => centreOfPressure(posture.agents[agent].wrenches[`${side}_foot`]));
    const outline = {
      type: "scatter",
      mode: "lines",
      name: `${side} sole`,
      x: [-wide, wide, wide, -wide, -wide].map((y) => middle + y),
      y: [-long, -long, long, long, -long],
      line: { color: colour("faint"), width: 1.2 },
      hoverinfo: "skip",
    };
    const path = {
      type: "scatter",
      mode: "lines+markers",
      name: `centre of pressure, ${side}`,
      x: centres.map((centre) => centre && middle - centre[1]),
      y: centres.map((centre) => centre && centre[0]),
      text: times.map((time) => `${figure(time, 3)} s`),
      hoverinfo: "text",
      line: { color: colour(index ? "second" : "accent"), width: 1.6 },
      marker: { size: times.map((_, moment) => (moment === 0 ? 9 : 4)) },
    };
    return [outline, path];
  });
  place.drawn = Plotly.react(
    place,
    traces,
    plotLayout({
      height: 270,
      margin: { l: 58, r: 6, t: 10, b: 38 },
      xaxis: plotAxis("to the right [m]", { zeroline: false, dtick: 0.1 }),
      yaxis: plotAxis("forward [m]", { zeroline: false, scaleanchor: "x", dtick: 0.1 }),
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
  const plotOf = (title) =>
    element("div", { class: "joint-plot", role: "img", "aria-label": `${title} over the time of the lift` });
  const plots = kinds.map(([title]) => plotOf(capital(title)));
  const soles = plotOf("Centres of pressure");
  const section = element(
    "details",
    { open: true, id: "over-time" },
    element("summary", { text: "Lift over time" }),
    element("div", { class: "choices", style: "margin-top:10px" }, agentSegments("over-time", (agent) => draw(agent))),
    element("p", { class: "hint", text: LIFT_HINT }),
    ...plots,
    soles,
  );
  const draw = (agent = whose) => {
    whose = agent;
    const at = shownCase();
    const moments = momentsOf(design, at);
    section.hidden = !isLift(at.stop) || !moments.postures.every(Boolean);
    if (section.hidden) return;
    kinds.forEach(([title, lines], place) =>
      drawOverTime(plots[place], moments.times, lines(moments, agent, design), title),
    );
    drawPressure(soles, moments, agent, at.person);
  };
  return { section, draw };
};
