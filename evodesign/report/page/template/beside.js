// Two designs in one card: the one that was put there and the chosen one, with the same case and camera.

const comparing = () => rowOf.has(state.beside) && state.beside !== state.selected;

const besideButton = (number) =>
  element("button", {
    ...{ type: "button", class: "quiet", id: "put-beside", text: "Compare" },
    title: "Put this design beside the one that you choose next",
    onclick: () => putBeside(number),
  });

const putBeside = (number) => {
  state.beside = number;
  drawCard();
  tell("view");
};

// What is compared, on top of the card; nothing where nothing is.
const besideHead = () =>
  rowOf.has(state.beside)
    ? element(
        "div",
        { id: "beside" },
        element(
          "div",
          { class: "heading" },
          element("h3", {
            id: "beside-title",
            text: comparing()
              ? `Design ${state.beside} beside design ${state.selected}`
              : `Design ${state.beside}: choose another one to see it beside this one`,
          }),
          element("button", {
            ...{ type: "button", class: "quiet", id: "close-beside", text: "End comparison" },
            onclick: () => putBeside(null),
          }),
        ),
      )
    : null;

// Rows of [name, first value, second value, unit] as a table with differences; texts have none.
const besideTable = (caption, lines) => {
  const shown = (value) => (typeof value === "number" ? exact(value) : (value ?? "–"));
  const difference = (a, b) => {
    if (typeof a !== "number" || typeof b !== "number") return "";
    return b === a ? "0" : `${b > a ? "+" : ""}${exact(b - a, 3)}`;
  };
  const heads = [caption, `${state.beside}`, `${state.selected}`, "difference"];
  return element(
    "table",
    { class: "beside-table" },
    headRow(heads.map((text, place) => [text, place ? "number" : ""])),
    element(
      "tbody",
      {},
      ...lines.map(([name, a, b, unit]) =>
        element(
          "tr",
          { "data-beside": name },
          element("th", { scope: "row" }, `${called(name)} `, element("small", { text: unit })),
          ...[shown(a), shown(b), difference(a, b)].map((text) => element("td", { class: "number", text })),
        ),
      ),
    ),
  );
};

const besideHardware = (first, second) => {
  if (!content.bodies || !first.postures.length || !second.postures.length) return [];
  if (!first.hardware || !second.hardware) {
    const [one, two] = [first, second].map((design) => treeOf("robot", design));
    const masses = content.bodies.changing.map((index) => [
      ...[one.links[index].name, one.links[index].mass_kg, two.links[index].mass_kg, "kg"],
    ]);
    return [besideTable("Masses", [...masses, ["whole robot", massOf(one), massOf(two), "kg"]])];
  }
  const [one, two] = [first.hardware, second.hardware];
  const parts = Object.keys(one.mass_kg).map((part) => [`mass: ${part}`, one.mass_kg[part], two.mass_kg[part], "kg"]);
  const actuators = one.actuators.flatMap((a) => {
    const b = two.actuators.find((other) => other.name === a.name);
    return [
      ...(a.model || b?.model ? [[`${a.name}: model`, a.model, b?.model, ""]] : []),
      [`${a.name}: rated`, a.rated_torque_n_m, b?.rated_torque_n_m, "N m"],
      [`${a.name}: mass of one`, a.mass_kg, b?.mass_kg, "kg"],
    ];
  });
  const walls = one.walls.map((a) => {
    const b = two.walls.find((other) => other.link === a.link);
    return [`${a.link}: wall`, 1000 * a.wall_m, b && 1000 * b.wall_m, "mm"];
  });
  return [besideTable("Bill of materials", [...parts, ...actuators, ...walls])];
};

// The largest torque of each joint over the heights, with the person and load that are shown.
const besideTorques = () =>
  agentsHere().flatMap((agent) => {
    const [one, two] = [state.beside, state.selected].map((number) => {
      const most = new Map();
      const design = content.designs[number] ?? NOTHING_KNOWN;
      for (const stop of everyStop)
        for (const [joint, torque] of Object.entries(torquesAt(design, agent, stop) ?? {}))
          most.set(joint, Math.max(most.get(joint) ?? 0, Math.abs(torque)));
      return most;
    });
    const joints = [...new Set([...one.keys(), ...two.keys()])];
    const size = (joint) => Math.max(one.get(joint) ?? 0, two.get(joint) ?? 0);
    joints.sort((a, b) => size(b) - size(a));
    if (!joints.length) return [];
    const lines = joints.map((joint) => [joint, one.get(joint), two.get(joint), "N m"]);
    return [besideTable(`${agentName(agent)}: most |torque|`, lines)];
  });

// The section of the card with all that differs; nothing where one design is shown.
const besideSection = () => {
  if (!comparing()) return null;
  const both = [state.beside, state.selected].map((number) => rowOf.get(number));
  const tables = (wanted, caption) =>
    besideTable(
      caption,
      wanted.map((axis) => [axis.name, axis.column[both[0]], axis.column[both[1]], unitText(axis.unit)]),
    );
  const designs = [state.beside, state.selected].map((number) => content.designs[number] ?? NOTHING_KNOWN);
  return fold(
    "Comparison",
    "differences are second less first",
    tables(resultAxes, "Results"),
    tables(axes.slice(resultAxes.length), "Parameters"),
    ...besideHardware(...designs),
    element("div", { id: "beside-torques" }, ...besideTorques()),
  );
};

const startBeside = () =>
  on("pair", () => byId("beside-torques")?.replaceChildren(...besideTorques()));
