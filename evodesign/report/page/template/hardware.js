// The bill of materials of a card: what drives the joints, what links are made of, where the mass is.

const headRow = (heads) =>
  element(
    "thead",
    {},
    element(
      "tr",
      {},
      ...heads.map(([text, kind]) => element("th", { scope: "col", class: kind ?? "number", text })),
    ),
  );

const wide = (table) => element("div", { class: "across" }, table);

// How much of an actuator is used; beyond all of it the bar is full and the figure tells.
const usedCell = (one) =>
  element(
    "td",
    { class: "number" },
    meter(one.share, null),
    element("span", { class: one.share > 1.0001 ? "beyond" : "", text: `${(100 * one.share).toFixed(0)} %` }),
  );

const actuatorTable = (hardware) => {
  const priced = hardware.actuators.some((one) => one.price_eur !== null);
  const heads = [["Joints", ""], ["Rated [N m]"], ["Peak [N m]"], ["kg each"], ["Used"], ["Loss [W]"]];
  if (priced) heads.push(["EUR each"]);
  const body = hardware.actuators.map((one) =>
    element(
      "tr",
      { "data-actuator": one.name },
      element(
        "th",
        { scope: "row" },
        `${one.count} × ${one.name}`,
        element("small", { text: one.model || "sized by the law" }),
        element("small", {
          text: one.asked_by ? `${one.joint}: ${figure(one.asked_n_m)} N m in ${one.asked_by}` : "nothing is asked of it",
        }),
      ),
      element("td", { class: "number", text: figure(one.rated_torque_n_m) }),
      element("td", { class: "number", text: figure(one.peak_torque_n_m) }),
      element("td", { class: "number", text: figure(one.mass_kg) }),
      usedCell(one),
      element("td", { class: "number", text: figure(one.loss_w) }),
      ...(priced ? [element("td", { class: "number", text: one.price_eur === null ? "" : figure(one.price_eur) })] : []),
    ),
  );
  return element(
    "table",
    { class: "bill" },
    element("caption", {
      text: "Below each group the joint that uses most of its actuator, and the case that asks for it: of rated torque in the lift, of peak torque where the robot stands alone (times the case's factor). Loss is the most in the lift, of all joints together.",
    }),
    headRow(heads),
    element("tbody", {}, ...body),
  );
};

const wallTable = (hardware) => {
  const body = hardware.walls.map((one) =>
    element(
      "tr",
      { "data-wall": one.link },
      element(
        "th",
        { scope: "row" },
        one.link,
        element("small", { text: (one.material ?? "").replaceAll("_", " ") }),
      ),
      element("td", { class: "number", text: figure(1000 * one.wall_m) }),
      element("td", { class: "number", text: figure(one.mass_kg) }),
      element(
        "td",
        { class: "number" },
        one.safety_factor === null ? "rigid" : figure(one.safety_factor),
        element("small", { text: one.safety_case ?? "" }),
      ),
    ),
  );
  return element(
    "table",
    { class: "bill" },
    element("caption", {
      text: "Without actuators. The safety factor is the least of all cases of the lift, against yield and buckling; links that are no beams are taken as rigid.",
    }),
    headRow([["Link", ""], ["Wall [mm]"], ["Mass [kg]"], ["Safety factor"]]),
    element("tbody", {}, ...body),
  );
};

const MASS_PARTS = { actuators: "actuators", structure: "structure (walls)", rest: "rest" };

const massSplit = (hardware) =>
  element(
    "table",
    { class: "bill" },
    element(
      "tbody",
      {},
      ...[...Object.entries(MASS_PARTS), ["total", "whole robot"]].map(([part, name]) =>
        element(
          "tr",
          { "data-mass": part },
          element("th", { scope: "row", text: name }),
          element("td", {}, part === "total" ? "" : meter(hardware.mass_kg[part] / hardware.mass_kg.total, null)),
          element("td", { class: "number", text: `${exact(hardware.mass_kg[part])} kg` }),
        ),
      ),
    ),
  );

const hardwareSections = (design) => {
  const hardware = design.hardware;
  if (!hardware) return [];
  const joints = hardware.actuators.reduce((sum, one) => sum + one.count, 0);
  const sections = [fold("Bill of materials", `${figure(hardware.mass_kg.total)} kg`, massSplit(hardware))];
  if (joints) sections.push(fold("Actuators", `${joints} joints`, wide(actuatorTable(hardware))));
  if (hardware.walls.length)
    sections.push(fold("Walls", `${hardware.walls.length} links`, wide(wallTable(hardware))));
  return sections;
};
