// Tables of a card: parameters, masses, contact wrenches, sensitivities.

const fold = (title, aside, ...children) =>
  element(
    "details",
    { open: true },
    element("summary", { text: title }, element("small", { text: aside })),
    ...children,
  );

const meter = (share, reference) => {
  const box = element(
    "div",
    { class: "meter", "aria-hidden": "true" },
    element("b", { style: `width:${100 * Math.min(1, Math.max(0, share))}%` }),
  );
  if (reference !== null)
    box.append(element("i", { style: `left:${100 * Math.min(1, Math.max(0, reference))}%` }));
  return box;
};

// The name of the material of a density as words, which break where they must; or nothing.
const materialOf = (axis, row) =>
  (axis.materials?.[axis.choices.indexOf(axis.column[row])] ?? "").replaceAll("_", " ");

const parameterTable = (row) => {
  const reference = unscaledMark ? rowOf.get(unscaledMark.number) : null;
  const body = axes.slice(resultAxes.length).map((axis) => {
    const share = (value) => (value - axis.lower) / (axis.upper - axis.lower);
    return element(
      "tr",
      {},
      element("th", { scope: "row", text: axis.name }),
      element(
        "td",
        {},
        meter(share(axis.column[row]), reference === null ? null : share(axis.column[reference])),
      ),
      element("td", { class: "number", "data-parameter": axis.name, text: exact(axis.column[row]) }),
      element("td", {
        text: `${axis.unit === "1" ? "×" : unitText(axis.unit)} ${materialOf(axis, row)}`.trim(),
      }),
    );
  });
  const tick = reference === null ? "" : "; the tick is the unscaled robot";
  return element(
    "table",
    {},
    element("caption", {
      text: `Each bar runs from the parameter's lower to its upper bound${tick}. × multiplies the unscaled length.`,
    }),
    element("tbody", {}, ...body),
  );
};

const massOf = (tree) => tree.links.reduce((sum, link) => sum + link.mass_kg, 0);

const massTable = (design) => {
  const [tree, before] = [treeOf("robot", design), content.bodies.robot];
  const changing = content.bodies.changing;
  const most = Math.max(
    ...changing.map((index) => Math.max(tree.links[index].mass_kg, before.links[index].mass_kg)),
    1e-9,
  );
  const line = (name, now, then, bar) =>
    element(
      "tr",
      {},
      element("th", { scope: "row", title: name, text: called(name) }),
      element("td", {}, bar),
      element("td", { class: "number", text: exact(now) }),
      element("td", { class: "number", text: exact(then) }),
    );
  const rest = (one) =>
    one.links.reduce((sum, link, index) => sum + (changing.includes(index) ? 0 : link.mass_kg), 0);
  const order = [...changing].sort((a, b) => tree.links[b].mass_kg - tree.links[a].mass_kg);
  const body = order.map((index) =>
    line(
      tree.links[index].name,
      tree.links[index].mass_kg,
      before.links[index].mass_kg,
      meter(tree.links[index].mass_kg / most, before.links[index].mass_kg / most),
    ),
  );
  const heads = [
    ["Link", ""],
    ["", ""],
    ["Design [kg]", "number"],
    ["Unscaled [kg]", "number"],
  ];
  return element(
    "table",
    {},
    element(
      "thead",
      {},
      element("tr", {}, ...heads.map(([text, kind]) => element("th", { scope: "col", class: kind, text }))),
    ),
    element(
      "tbody",
      {},
      ...body,
      line("all other links", rest(tree), rest(before), ""),
      line("whole robot", massOf(tree), massOf(before), ""),
    ),
  );
};

// Forces with one decimal, moments with two.
const wrenchCells = (wrench) =>
  wrench.map((value, index) => {
    const text = value
      .toFixed(index < 3 ? 1 : 2)
      .replace(/^-(?=[0.]+$)/, "")
      .replace("-", "\u2212");
    return element("td", { class: "number", text });
  });

const wrenchTable = (posture) => {
  const heads = ["", "Fx [N]", "Fy [N]", "Fz [N]", "Mx [N m]", "My [N m]", "Mz [N m]"];
  const lines = (wrenches) =>
    Object.entries(wrenches).map(([contact, wrench]) =>
      element("tr", {}, element("th", { scope: "row", text: contact.replace("_", " ") }), ...wrenchCells(wrench)),
    );
  const groups = Object.entries(posture.agents).map(([agent, one]) =>
    element(
      "tbody",
      { "data-agent": agent },
      element(
        "tr",
        { class: "group" },
        element("th", { colspan: heads.length, scope: "rowgroup", text: agentName(agent) }),
      ),
      ...lines(one.wrenches),
    ),
  );
  return element(
    "table",
    { class: "wrenches" },
    element("caption", {
      text: "Force and moment on the agent: a foot's in its sole frame, a hand's about the grasp point in the frame of the agent, who looks along +x at the load.",
    }),
    element(
      "thead",
      {},
      element(
        "tr",
        {},
        ...heads.map((text, index) => element("th", { scope: "col", class: index ? "number" : "", text })),
      ),
    ),
    ...groups,
  );
};

// First-order change of an objective when a parameter grows by a tenth of its range.
const sensitivityTable = (objective, gradient) => {
  const lines = parameters
    .filter((one) => one.name in gradient)
    .map((one) => ({
      one,
      slope: gradient[one.name],
      change: (gradient[one.name] * (one.upper - one.lower)) / 10,
    }));
  lines.sort((a, b) => Math.abs(b.change) - Math.abs(a.change));
  const most = Math.max(...lines.map((line) => Math.abs(line.change)), 1e-12);
  const bar = (change) => {
    const share = (50 * Math.abs(change)) / most;
    return element(
      "div",
      { class: "meter diverging", "aria-hidden": "true" },
      element("b", {
        class: change < 0 ? "down" : "up",
        style: `left:${change < 0 ? 50 - share : 50}%;width:${share}%`,
      }),
      element("i", { style: "left:50%" }),
    );
  };
  const body = lines.map(({ one, slope, change }) =>
    element(
      "tr",
      { title: `${figure(slope)} ${objective.unit} per ${one.unit === "1" ? "unit" : unitText(one.unit)}` },
      element("th", { scope: "row", text: one.name }),
      element("td", {}, bar(change)),
      element("td", {
        class: "number",
        text: `${change > 0 ? "+" : ""}${exact(change, 3)} ${unitText(objective.unit)}`,
      }),
    ),
  );
  return element(
    "table",
    {},
    element("caption", {
      text: `Change of ${words(objective.name)} when a parameter grows by a tenth of its range, to first order.`,
    }),
    element("tbody", {}, ...body),
  );
};

const sensitivities = (design) => {
  const known = resultAxes.filter(({ name }) => Object.keys(design.gradients[name] ?? {}).length > 0);
  if (known.length === 0) return null;
  const place = element("div");
  const draw = (axis) =>
    place.replaceChildren(sensitivityTable(axis, design.gradients[axis.name]));
  const segments = element(
    "span",
    { class: "segments", role: "radiogroup", "aria-label": "Of which quantity" },
    ...known.map((axis, index) =>
      element(
        "label",
        {},
        element("input", {
          type: "radio",
          name: "sensitivity",
          checked: index === 0,
          onchange: () => draw(axis),
        }),
        words(axis.name),
      ),
    ),
  );
  draw(known[0]);
  return fold(
    "Sensitivities",
    "",
    element("div", { class: "choices", style: "margin:10px 0" }, segments),
    place,
  );
};
