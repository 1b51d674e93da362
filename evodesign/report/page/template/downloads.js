// Files of the chosen design that the card offers: CSV, URDF and replay.

const save = (name, parts, type) => {
  const link = element("a", { href: URL.createObjectURL(new Blob(parts, { type })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
};

const csvText = (lines) => {
  const cell = (value) => (/[",\r\n]/.test(value) ? `"${String(value).replaceAll('"', '""')}"` : value);
  return lines.map((line) => `${line.map(cell).join(",")}\n`).join("");
};

// Objectives, constrained quantities and parameters of a design, a row each.
const designCsv = (row) =>
  csvText([
    ["kind", "name", "value", "unit"],
    ...axes.map((axis) => {
      const kind = axis.isParameter ? "parameter" : isObjective(axis.name) ? "objective" : "constraint";
      return [kind, axis.name, axis.column[row] ?? "", axis.unit];
    }),
  ]);

const BASE = ["x", "y", "z", "roll", "pitch", "yaw"];

// Postures in the columns of an exported folder's postures.csv.
const posturesCsv = (design) => {
  const named = design.postures.some((one) => one.case.person || one.case.payload);
  const moves = stops.some(({ task }) => task.kind === "lift");
  const columns = "height_m,agent,kind,name,position,position_unit,torque,torque_unit".split(",");
  const lines = design.postures.flatMap((detail) => {
    const { person = "", payload = "", task } = detail.case;
    return detail.instants.flatMap((instant) => Object.keys(instant.agents).flatMap((agent) => {
      const posture = instant.agents[agent];
      const joints = new Map(treeOf(agent, design, person).joints.map((one) => [one.name, one.kind]));
      const first = [
        ...(named ? [person, payload] : []),
        ...(moves ? [taskNames[JSON.stringify(task)], instant.time_s] : []),
        instant.load_height_m ?? task.height_m,
        agent,
      ];
      const base = [...posture.base_position_m, ...posture.base_rpy_rad];
      return [
        ...BASE.map((name, place) => [...first, "base", name, base[place], place < 3 ? "m" : "rad", "", ""]),
        ...Object.entries(posture.joints_rad).map(([name, position]) => {
          const slides = joints.get(name) === "prismatic";
          const torque = [posture.torques_n_m[name], slides ? "N" : "N m"];
          return [...first, joints.get(name), name, position, slides ? "m" : "rad", ...torque];
        }),
      ];
    }));
  });
  const heads = [...(named ? ["human", "payload"] : []), ...(moves ? ["task", "time_s"] : [])];
  return csvText([[...heads, ...columns], ...lines]);
};

const urdfOf = (design) => {
  if (typeof design.urdf === "string") return design.urdf;
  const lines = content.urdf.split("\n");
  const written = (part) => (Number.isInteger(part) ? part.toFixed(1) : part);
  for (const [place, parts] of Object.entries(design.urdf)) lines[place] = parts.map(written).join("");
  return lines.join("\n");
};

const downloads = (row, design) => {
  const number = points.number[row];
  const stem = `${content.facts.problem}-design-${number}`.replaceAll(/[^\w.-]+/g, "_");
  const offer = (id, text, name, type, made) =>
    element("button", {
      ...{ type: "button", class: "quiet", id: `save-${id}`, text },
      onclick: () => save(`${stem}${name}`, [made()], type),
    });
  const offers = [offer("csv", "CSV", ".csv", "text/csv", () => designCsv(row))];
  const drawn = design.postures.length > 0 && content.urdf;
  if (drawn) {
    offers.push(offer("postures", "Postures CSV", "-postures.csv", "text/csv", () => posturesCsv(design)));
    offers.push(offer("urdf", "URDF", ".urdf", "application/xml", () => urdfOf(design)));
  }
  if (design.replay) {
    const bytes = () => Uint8Array.from(atob(design.replay), (letter) => letter.charCodeAt(0));
    offers.push(offer("replay", "Replay", ".mcap", "application/octet-stream", bytes));
  }
  const missing = drawn && design.replay ? "" : `With replay and meshes: evodesign export RUN ${number} --to DIR`;
  return element(
    "div",
    { class: "downloads" },
    element("span", { class: "hint", text: "Download" }),
    ...offers,
    ...(missing ? [element("span", { class: "hint", text: missing })] : []),
  );
};
