// Joint torques of a design with the person and load that are shown: boxes over the joints at each height,
// beside the unscaled robot's (the paper's figure), and every joint at every height.


const torquesAt = (design, agent, stop) => {
  const posture = postureAt(design, { ...shownCase(), stop });
  return posture?.agents[agent]?.torques_n_m ?? null;
};

const boxTrace = (design, agent, name, ink, filled) => {
  const [x, y, text] = [[], [], []];
  for (const stop of everyStop) {
    for (const [joint, torque] of Object.entries(torquesAt(design, agent, stop) ?? {})) {
      x.push(stopText(stop));
      y.push(Math.abs(torque));
      text.push(`${plain(called(joint))}<br>${exact(torque)} N m`);
    }
  }
  return {
    type: "box",
    name,
    x,
    y,
    text,
    hoverinfo: "text",
    boxpoints: "all",
    jitter: 0.5,
    pointpos: 0,
    line: { color: colour(ink), width: 1.4 },
    fillcolor: filled ? colour("accent-wash") : "rgba(0,0,0,0)",
    marker: { size: 3, color: colour(ink), opacity: 0.55 },
  };
};

const drawBoxes = (place, number, design, agent) => {
  const reference =
    unscaledMark && unscaledMark.number !== number ? content.designs[unscaledMark.number] : null;
  const traces = [boxTrace(design, agent, `Design ${number}`, "accent", true)];
  if (reference?.postures.length) traces.push(boxTrace(reference, agent, "Unscaled robot", "soft", false));
  place.drawn = Plotly.react(
    place,
    traces,
    plotLayout({
      boxmode: "group",
      boxgap: 0.25,
      height: 250,
      showlegend: traces.length > 1,
      legend: { orientation: "h", x: 0, y: 1.02, yanchor: "bottom", font: plotFont() },
      margin: { l: 46, r: 6, t: 30, b: 38 },
      xaxis: plotAxis(stops.some(({ task }) => task.kind === "lift") ? "moment" : "height of the load", {
        categoryorder: "array",
        categoryarray: everyStop.map(stopText),
      }),
      yaxis: plotAxis("|torque| [N m]", { rangemode: "tozero", zeroline: false }),
    }),
    { ...plotConfig, displayModeBar: false },
  );
};

const JOINT_SYMBOLS = ["circle", "diamond", "square", "triangle-up", "cross", "x", "star", "hexagon"];

const drawJoints = (place, design, agent) => {
  const solved = everyStop.filter((stop) => torquesAt(design, agent, stop));
  const joints = [...new Set(solved.flatMap((stop) => Object.keys(torquesAt(design, agent, stop))))];
  const most = (joint) =>
    Math.max(...solved.map((stop) => Math.abs(torquesAt(design, agent, stop)[joint] ?? 0)));
  const sizes = joints.map((joint) => [joint, most(joint)]).sort((a, b) => a[1] - b[1]);
  const order = sizes.filter(([, size]) => size > NOTHING * sizes.at(-1)[1]).map(([joint]) => joint);
  const idle = joints.length - order.length;
  const rowName = (joint) => plain(called(joint)).replace(", ", narrow.matches ? ",<br>" : ", ");
  place.previousSibling.textContent = `Each joint with its sign, the most loaded first${idle ? `; ${idle} more carry nothing` : ""}.`;
  const inks = (index) =>
    mixedColour("accent", "second", solved.length > 1 ? index / (solved.length - 1) : 0);
  const traces = solved.map((stop, index) => {
    const torques = torquesAt(design, agent, stop);
    return {
      type: "scatter",
      mode: "markers",
      name: stopText(stop),
      x: order.map((joint) => torques[joint] ?? null),
      y: order.map(rowName),
      text: order.map((joint) => `${plain(called(joint))} at ${stopText(stop)}<br>${exact(torques[joint])} N m`),
      hoverinfo: "text",
      marker: {
        size: 7,
        symbol: JOINT_SYMBOLS[index % JOINT_SYMBOLS.length],
        color: inks(index),
        opacity: 0.9,
      },
    };
  });
  place.drawn = Plotly.react(
    place,
    traces,
    plotLayout({
      height: 86 + (narrow.matches && order.some((joint) => rowName(joint).includes("<br>")) ? 32 : 16) * order.length,
      showlegend: true,
      legend: { orientation: "h", x: 0, y: 1, yanchor: "bottom", font: plotFont() },
      margin: { l: 8, r: 8, t: 30, b: 40 },
      xaxis: plotAxis("torque [N m]", { zeroline: true, zerolinecolor: colour("faint"), nticks: 5, tickangle: 0 }),
      yaxis: plotAxis("", {
        automargin: true,
        type: "category",
        ticks: "",
        tickfont: { ...plotFont(), size: 11.5 },
        dtick: 1,
        range: [-0.7, order.length - 0.3],
      }),
    }),
    { ...plotConfig, displayModeBar: false },
  );
};

// Whose torques: those of robots first, then those of people.
const agentSegments = (name, choose, agents = agentsHere(), called = agentName) =>
  element(
    "span",
    { class: "segments", role: "radiogroup", "aria-label": "Whose torques" },
    ...agents.map((agent, place) =>
      element(
        "label",
        {},
        element("input", {
          type: "radio",
          name,
          checked: place === 0,
          onchange: () => choose(agent),
        }),
        called(agent),
      ),
    ),
  );

const torqueSection = (number, design) => {
  let [whose] = agentsHere();
  const boxes = element("div", { class: "joint-plot", role: "img" });
  const dots = element("div", { class: "joint-plot", role: "img" });
  const hint = element("p", { class: "hint" });
  const draw = (agent) => {
    whose = agent;
    const pair = pairText(shownCase());
    hint.textContent = `Sizes over all joints that move, one point per joint, at each height${pair ? `: ${pair}` : ""}.`;
    boxes.setAttribute(
      "aria-label",
      `Box plot of the ${agentName(agent).toLowerCase()}'s joint torques at each height`,
    );
    dots.setAttribute(
      "aria-label",
      `The ${agentName(agent).toLowerCase()}'s torque of each joint at each height`,
    );
    drawBoxes(boxes, number, design, agent);
    drawJoints(dots, design, agent);
  };
  const section = element(
    "details",
    { open: true },
    element("summary", { text: "Joint torques" }),
    element("div", { class: "choices", style: "margin-top:10px" }, agentSegments("torques", draw)),
    hint,
    boxes,
    element("p", { class: "hint" }),
    dots,
  );
  return { section, draw: () => draw(whose) };
};
