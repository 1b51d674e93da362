// The card of the chosen design: what it is worth, how it stands, what it is made of.

let viewer = null;
let shownScene = null;
const stillness = window.matchMedia("(prefers-reduced-motion: reduce)");

const fold = (title, aside, open, ...children) =>
  element("details", { open }, element("summary", { text: title }, element("small", { text: aside })), ...children);

const against = (axis, row) => {
  const reference = unscaledMark ? axis.column[rowOf.get(unscaledMark.number)] : null;
  if (reference === null || reference === undefined || axis.column[row] === null) return "";
  if (points.number[row] === unscaledMark.number) return "";
  return `unscaled ${exact(reference)}`;
};

const worth = (row) => element("dl", { class: "worth" }, ...axes.slice(0, objectives.length).map((axis) => element("div", {},
  element("dt", { text: `${capital(words(axis.name))} ${axis.sense === "minimise" ? "↓" : "↑"}` }),
  element("dd", { "data-objective": axis.name }, exact(axis.column[row]), element("small", { text: axis.column[row] === null ? " no value" : ` ${unitText(axis.unit)}` }), element("span", { class: "against", text: against(axis, row) })))));

const cardHead = (row) => {
  const number = points.number[row];
  const kind = { front: "on the front", feasible: "dominated", infeasible: "not feasible" }[points.kind[row]];
  const labels = [...new Set(marksOf(number).map((mark) => `${symbolOf[mark.kind]} ${mark.label}`)), kind];
  const step = (text, name, by) => element("button", { type: "button", class: "quiet", "aria-label": name, text, onclick: () => walk(by) });
  const head = element("div", {},
    element("div", { class: "heading" }, element("h2", { id: "card-title", text: `Design ${number}` }),
      element("span", { class: "choices" }, ...(hasFront ? [step("‹", "Previous design of the front", -1), step("›", "Next design of the front", 1)] : []))),
    element("p", { class: "labels", text: labels.join(" · ") }), worth(row), reachFigure(row));
  if (points.reason[row]) head.append(element("p", { class: "plain", text: capital(points.reason[row]) + (points.violation_m[row] === null ? "" : ` (violation ${figure(points.violation_m[row])} m)`) }));
  return head;
};

// The interval of load heights that the robot can hold, with the required ones.
const reachFigure = (row) => {
  const [low, high] = [points.lowest_m[row], points.highest_m[row]];
  const box = element("div", { class: "reach" });
  if (low === null || high === null) {
    box.append(element("p", { class: "plain", text: "Reach interval not known." }));
    return box;
  }
  const known = points.highest_m.filter((value) => value !== null);
  const most = Math.max(known.reduce((a, b) => Math.max(a, b), 0), ...content.heights_m, 1) * 1.02;
  const width = 444;
  const x = (height) => (width * height) / most;
  const within = (height) => height >= low && height <= high;
  const ticks = content.heights_m.map((height) => `<g${within(height) ? "" : ' class="out"'}><line x1="${x(height)}" x2="${x(height)}" y1="16" y2="30" stroke="var(--${within(height) ? "ink" : "second"})" stroke-width="1.5"/><text x="${x(height)}" y="44" text-anchor="middle"${within(height) ? "" : ' class="out"'}>${figure(height)}</text></g>`).join("");
  box.innerHTML = `<svg viewBox="0 0 ${width} 46" role="img" aria-label="Holds loads from ${figure(low)} to ${figure(high)} m">
    <line x1="0" x2="${width}" y1="23" y2="23" stroke="var(--line)" stroke-width="8" stroke-linecap="round"/>
    <line x1="${x(low)}" x2="${x(high)}" y1="23" y2="23" stroke="var(--accent)" stroke-width="8"/>${ticks}
    <text x="0" y="10">Holds loads from ${figure(low)} to ${figure(high)} m; required heights [m] below</text></svg>`;
  return box;
};

const stageOf = () => {
  const canvas = element("canvas", { id: "posture", tabindex: 0, role: "img" });
  const views = element("div", { class: "views" }, ...Object.entries(VIEWS).map(([name, [turn, tilt]]) => element("button", { type: "button", class: "quiet", text: name, onclick: () => viewer.look(turn, tilt) })));
  const missing = element("p", { class: "missing", hidden: true });
  const key = (ink, text) => element("span", {}, element("i", { style: `background:${ink}` }), text);
  const legend = element("p", { class: "legend" },
    key("var(--accent)", "robot: links that designs change"), key("color-mix(in srgb, var(--accent) 48%, var(--surface))", "other links"),
    key("color-mix(in srgb, var(--second) 65%, var(--faint))", "person"), key("var(--third)", `force of the ground, 1 m for ${NEWTONS_PER_METRE} N`));
  return element("div", { class: "stage" }, canvas, views, missing, legend);
};

const heightControl = (design) => {
  const last = content.heights_m.length - 1;
  const slider = element("input", { type: "range", id: "height", min: 0, max: last, step: 1, value: state.height, disabled: last === 0 });
  const output = element("output", { for: "height" });
  const detail = element("p", { id: "height-detail" });
  const show = () => {
    const height = content.heights_m[state.height];
    const outcome = design.heights.find((one) => one.height_m === height);
    output.textContent = heightText(height);
    const solved = outcome?.status === "solved";
    detail.textContent = outcome
      ? solved ? `Solved: robot |torque| ${exact(outcome.robot_torque_norm)} N m, person ${exact(outcome.human_torque_norm)} N m; largest residual ${figure(outcome.residual, 2)}` : `${capital(outcome.status)}: ${outcome.reason}`
      : "The log holds no outcome for this height.";
    slider.value = state.height;
    slider.setAttribute("aria-valuetext", `${heightText(height)}, ${outcome?.status ?? "unknown"}`);
  };
  slider.addEventListener("input", () => { state.height = Number(slider.value); tell("height"); });
  const box = element("div", { class: "height" }, element("label", { for: "height", text: "Height of the load" }), slider, output, detail);
  return { box, show };
};

const showPosture = (number, design, moving) => {
  const height = content.heights_m[state.height];
  const posture = design.postures.find((one) => one.height_m === height);
  const missing = byId("card").querySelector(".missing");
  missing.hidden = Boolean(posture);
  missing.textContent = posture ? "" : `No posture at ${heightText(height)}.`;
  byId("posture").setAttribute("aria-label", posture ? `Design ${number} and the person holding the load at ${heightText(height)}. Arrow keys turn the view.` : missing.textContent);
  const from = shownScene?.number === number ? shownScene : null;
  if (!posture) { shownScene = null; viewer.show(sceneItems(design, {}, height)); return; }
  const target = { number, height, agents: posture.agents };
  if (!moving || !from || stillness.matches) { shownScene = target; viewer.show(sceneItems(design, target.agents, height)); return; }
  const begun = performance.now();
  shownScene = target;
  const frame = (now) => {
    if (shownScene !== target) return;
    const linear = Math.min(1, Math.max(0, (now - begun) / 280));
    const share = linear * linear * (3 - 2 * linear);
    const agents = share === 1 ? target.agents : Object.fromEntries(Object.entries(target.agents).map(([name, to]) => [name, between(from.agents[name], to, share)]));
    viewer.show(sceneItems(design, agents, from.height + share * (height - from.height)));
    if (linear < 1) requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
};

const meter = (share, reference) => {
  const box = element("div", { class: "meter", "aria-hidden": "true" }, element("b", { style: `width:${100 * Math.min(1, Math.max(0, share))}%` }));
  if (reference !== null) box.append(element("i", { style: `left:${100 * Math.min(1, Math.max(0, reference))}%` }));
  return box;
};

const parameterTable = (row) => {
  const reference = unscaledMark ? rowOf.get(unscaledMark.number) : null;
  const body = axes.slice(objectives.length).map((axis) => {
    const share = (value) => (value - axis.lower) / (axis.upper - axis.lower);
    return element("tr", {}, element("th", { scope: "row", text: axis.name }),
      element("td", {}, meter(share(axis.column[row]), reference === null ? null : share(axis.column[reference]))),
      element("td", { class: "number", "data-parameter": axis.name, text: exact(axis.column[row]) }),
      element("td", { text: axis.unit === "1" ? "×" : unitText(axis.unit) }));
  });
  const tick = reference === null ? "" : "; the tick is the unscaled robot";
  return element("table", {}, element("caption", { text: `Each bar runs from the parameter's lower to its upper bound${tick}. × multiplies the unscaled length.` }), element("tbody", {}, ...body));
};

const massOf = (tree) => tree.links.reduce((sum, link) => sum + link.mass_kg, 0);

const massTable = (design) => {
  const [tree, before] = [treeOf("robot", design), content.bodies.agents.robot];
  const changing = content.bodies.changing;
  const most = Math.max(...changing.map((index) => Math.max(tree.links[index].mass_kg, before.links[index].mass_kg)), 1e-9);
  const line = (name, now, then, bar) => element("tr", {}, element("th", { scope: "row", text: name }), element("td", {}, bar),
    element("td", { class: "number", text: exact(now) }), element("td", { class: "number", text: exact(then) }));
  const rest = (one) => one.links.reduce((sum, link, index) => sum + (changing.includes(index) ? 0 : link.mass_kg), 0);
  const order = [...changing].sort((a, b) => tree.links[b].mass_kg - tree.links[a].mass_kg);
  const body = order.map((index) => line(tree.links[index].name, tree.links[index].mass_kg, before.links[index].mass_kg, meter(tree.links[index].mass_kg / most, before.links[index].mass_kg / most)));
  const heads = [["Link", ""], ["", ""], ["Design [kg]", "number"], ["Unscaled [kg]", "number"]];
  return element("table", {}, element("thead", {}, element("tr", {}, ...heads.map(([text, kind]) => element("th", { scope: "col", class: kind, text })))),
    element("tbody", {}, ...body, line("all other links", rest(tree), rest(before), ""), line("whole robot", massOf(tree), massOf(before), "")));
};

// Forces with one decimal, moments with two.
const wrenchCells = (wrench) => wrench.map((value, index) => {
  const text = value.toFixed(index < 3 ? 1 : 2).replace(/^-(?=[0.]+$)/, "").replace("-", "\u2212");
  return element("td", { class: "number", text });
});

const wrenchTable = (posture) => {
  const heads = ["", "Fx [N]", "Fy [N]", "Fz [N]", "Mx [N m]", "My [N m]", "Mz [N m]"];
  const lines = (part, wrenches) => Object.entries(wrenches).map(([side, wrench]) =>
    element("tr", {}, element("th", { scope: "row", text: `${side} ${part}` }), ...wrenchCells(wrench)));
  const groups = Object.entries(posture.agents).map(([agent, one]) => element("tbody", { "data-agent": agent },
    element("tr", { class: "group" }, element("th", { colspan: heads.length, scope: "rowgroup", text: AGENT_NAMES[agent] })),
    ...lines("foot", one.foot_wrenches), ...lines("hand", one.hand_wrenches)));
  return element("table", { class: "wrenches" },
    element("caption", { text: "Force and moment on the agent: a foot's in its sole frame, a hand's about the grasp point in the frame of the agent, who looks along +x at the load." }),
    element("thead", {}, element("tr", {}, ...heads.map((text, index) => element("th", { scope: "col", class: index ? "number" : "", text })))), ...groups);
};

// First-order change of an objective when a parameter grows by a tenth of its range.
const sensitivityTable = (objective, gradient) => {
  const lines = parameters.filter((one) => one.name in gradient).map((one) => ({ one, slope: gradient[one.name], change: (gradient[one.name] * (one.upper - one.lower)) / 10 }));
  lines.sort((a, b) => Math.abs(b.change) - Math.abs(a.change));
  const most = Math.max(...lines.map((line) => Math.abs(line.change)), 1e-12);
  const bar = (change) => {
    const share = (50 * Math.abs(change)) / most;
    return element("div", { class: "meter diverging", "aria-hidden": "true" }, element("b", { class: change < 0 ? "down" : "up", style: `left:${change < 0 ? 50 - share : 50}%;width:${share}%` }), element("i", { style: "left:50%" }));
  };
  const body = lines.map(({ one, slope, change }) => element("tr", { title: `${figure(slope)} ${objective.unit} per ${one.unit === "1" ? "unit" : unitText(one.unit)}` },
    element("th", { scope: "row", text: one.name }), element("td", {}, bar(change)), element("td", { class: "number", text: `${change > 0 ? "+" : ""}${figure(change, 3)} ${objective.unit}` })));
  return element("table", {}, element("caption", { text: `Change of ${words(objective.name)} when a parameter grows by a tenth of its range, to first order.` }), element("tbody", {}, ...body));
};

const sensitivities = (design) => {
  const known = objectives.filter((objective) => Object.keys(design.gradients[objective.name] ?? {}).length > 0);
  if (known.length === 0) return null;
  const place = element("div");
  const draw = (objective) => place.replaceChildren(sensitivityTable(objective, design.gradients[objective.name]));
  const segments = element("span", { class: "segments", role: "radiogroup", "aria-label": "Of which objective" },
    ...known.map((objective, index) => element("label", {}, element("input", { type: "radio", name: "sensitivity", checked: index === 0, onchange: () => draw(objective) }), words(objective.name))));
  draw(known[0]);
  return fold("Sensitivities", "", true, element("div", { class: "choices", style: "margin:10px 0" }, segments), place);
};

const whyNoPosture = (row) => {
  if (!content.bodies) return "The robot cannot be drawn: see the notes at the top.";
  if (points.kind[row] === "front") return "The postures of this design are not in this page: see the notes at the top.";
  if (points.kind[row] === "infeasible") return "The log keeps no postures of a design that is not feasible.";
  return "The log keeps postures of designs that nothing before them had beaten; this one was beaten when it arrived.";
};

let redrawPlots = () => {};

const drawCard = () => {
  const card = byId("card");
  const row = rowOf.get(state.selected);
  if (row === undefined) return;
  const design = content.designs[state.selected] ?? { heights: [], postures: [], gradients: {}, links: {}, joints: {} };
  const drawn = content.bodies !== null && design.postures.length > 0;
  const folded = new Map([...card.querySelectorAll("details")].map((one) => [one.querySelector("summary").firstChild.textContent, one.open]));
  const stage = card.querySelector(".stage");
  const parts = [cardHead(row)];
  let height = null;
  let torques = null;
  const wrenches = element("div");
  if (drawn) {
    height = heightControl(design);
    torques = torqueSection(state.selected, design);
    parts.push(hasWebgl ? stage ?? stageOf() : element("p", { class: "plain", style: "padding:0 20px", text: "This browser offers no WebGL, so postures are not drawn; their figures are below." }), height.box);
  } else {
    parts.push(element("div", {}, element("p", { class: "plain", text: whyNoPosture(row) })));
  }
  parts.push(fold("Parameters", `${parameters.length}`, true, parameterTable(row)));
  if (drawn) {
    parts.push(torques.section, fold("Masses", `robot ${figure(massOf(treeOf("robot", design)))} kg`, true, massTable(design)), fold("Contact wrenches", "", true, wrenches));
    const found = sensitivities(design);
    if (found) parts.push(found);
  }
  card.replaceChildren(...parts);
  for (const one of card.querySelectorAll("details")) one.open = folded.get(one.querySelector("summary").firstChild.textContent) ?? one.open;
  card.scrollTop = 0;
  showHeight = () => {};
  redrawPlots = () => {};
  if (!drawn) { shownScene = null; return; }
  redrawPlots = torques.draw;
  torques.draw();
  if (hasWebgl && !viewer) { viewer = new Viewer(byId("posture")); steer(viewer); }
  showHeight = (moving) => {
    height.show();
    const posture = design.postures.find((one) => one.height_m === content.heights_m[state.height]);
    wrenches.replaceChildren(posture ? wrenchTable(posture) : element("p", { class: "plain", text: "No posture at this height." }));
    if (hasWebgl) showPosture(state.selected, design, moving);
  };
  showHeight(false);
};

let showHeight = () => {};

const startCard = () => {
  if (points.number.length === 0) {
    byId("card").append(element("div", {}, element("h2", { id: "card-title", text: "No design yet" }), element("p", { class: "plain", text: "Designs appear here as soon as the run holds an evaluation." })));
    return;
  }
  on("selected", drawCard);
  on("height", () => showHeight(true));
  on("theme", () => { redrawPlots(); showHeight(false); });
  const solvable = content.heights_m.length > 1 ? 1 : 0;
  state.height = solvable;
};
