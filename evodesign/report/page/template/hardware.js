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

// What is asked of a group, below it: the share that is used as a bar, and by what.
const askedRow = (one, columns) => {
  const used = `${figure(100 * one.share, 3)} % used: ${called(one.joint)} needs ${figure(one.asked_n_m, 3)} N m (${one.asked_by})`;
  return element(
    "tr",
    { class: "asked" },
    element(
      "td",
      { colspan: columns },
      meter(one.share, null),
      element("span", {
        class: one.share > 1.0001 ? "beyond" : "",
        text: one.asked_by ? used : "nothing is asked of it",
      }),
    ),
  );
};

const smallest = (value) => (value === null ? "" : 0 < value && value < 0.01 ? "< 0.01" : figure(value, 3));

// Which parts have least room, where actuators are bodies.
const clearanceWords = (room) => {
  if (!room) return "";
  const [one, other] = room.parts.map(inWords);
  const fit = room.clearance_m < 0 ? " too little" : "";
  return ` ${one} and ${other} have least room: ${figure(1000 * Math.abs(room.clearance_m), 2)} mm${fit}.`;
};

const actuatorTable = (hardware) => {
  const priced = hardware.actuators.some((one) => one.price_eur !== null);
  const heads = [["Joints", ""], ["Rated [N m]"], ["Peak [N m]"], ["Mass [kg]"], ["Loss [W]"]];
  if (priced) heads.push(["Price [EUR]"]);
  const cell = (value) => element("td", { class: "number", text: smallest(value) });
  const groups = hardware.actuators.map((one) =>
    element(
      "tbody",
      { "data-actuator": one.name },
      element(
        "tr",
        {},
        element("th", { scope: "row" }, `${one.count} × ${one.name}`, element("small", { text: one.model })),
        cell(one.rated_torque_n_m),
        cell(one.peak_torque_n_m),
        cell(one.mass_kg),
        cell(one.loss_w),
        ...(priced ? [cell(one.price_eur)] : []),
      ),
      askedRow(one, heads.length),
    ),
  );
  return element(
    "table",
    { class: "bill" },
    element("caption", {
      text: "Mass and price of one; loss is the most in the lift, of all joints of the group. Used: of rated torque in the lift, of peak torque where the robot stands alone, times the case's factor." + clearanceWords(hardware.least_clearance),
    }),
    headRow(heads),
    ...groups,
  );
};

const wallTable = (hardware) => {
  const body = hardware.walls.map((one) =>
    element(
      "tr",
      { "data-wall": one.link },
      element(
        "th",
        { scope: "row", title: one.link },
        called(one.link),
        element("small", { text: (one.material ?? "").replaceAll("_", " ") }),
      ),
      element("td", { class: "number", text: figure(1000 * one.wall_m, 3) }),
      element("td", { class: "number", text: figure(one.mass_kg, 3) }),
      element(
        "td",
        { class: "number" },
        one.safety_factor === null ? "rigid" : figure(one.safety_factor, 3),
        element("small", { text: one.safety_factor === null ? "" : `${one.safety_mode}, ${one.safety_case}` }),
      ),
    ),
  );
  return element(
    "table",
    { class: "bill" },
    element("caption", {
      text: "Without actuators. The safety factor is the least of all cases and load cases, against yield and buckling; links that are no beams are taken as rigid.",
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
    element("caption", { text: `${hardware.governs.join(". ")}.` }),
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
  if (joints) sections.push(fold("Actuators", `${joints} joints`, actuatorTable(hardware)));
  if (hardware.walls.length)
    sections.push(fold("Walls", `${hardware.walls.length} links`, wallTable(hardware)));
  return sections;
};
