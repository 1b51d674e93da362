// Where somebody should look, in the card of a design: of the design, and of the case that is shown.

const NEAR = 0.002; // bodies nearer than this nearly touch [m]
const NOTHING = 1e-3; // share of an agent's largest torque below which a joint carries nothing
const FULL = 0.95; // share of a bound from which a value is at it
const MOST_NAMES = 4;

const listed = (names) => {
  const rest = names.length - MOST_NAMES;
  return rest > 1 ? `${names.slice(0, MOST_NAMES).join("; ")} and ${rest} more` : names.join("; ");
};

// Constraints that a design is at or beyond, temperatures of windings, parts, and what is asked of actuators.
const designRemarks = (row, { hardware }) => [
  ...constraints.map(({ name, unit, lower, upper }) => {
    const value = points.constraints[name][row] ?? points.objectives[name]?.[row] ?? null;
    const bounds = [lower, upper].filter((bound) => bound !== null);
    const margin = 0.02 * Math.max(...bounds.map(Math.abs));
    const at = value !== null && margin > 0 && bounds.find((bound) => Math.abs(value - bound) <= margin);
    const beyond = isBeyond({ lower, upper }, value);
    if (!beyond && typeof at !== "number") return null;
    return ["constraint", `${capital(words(name))} ${withUnit(value, unit)} is ${beyond ? "beyond" : "near"} its bound: ${boundsText({ lower, upper, unit })}.`];
  }),
  hardware?.least_clearance?.clearance_m < 0 && [
    "parts",
    `Parts do not fit: ${hardware.least_clearance.parts.map(inWords).join(" and ")} lack ${figure(-1000 * hardware.least_clearance.clearance_m, 2)} mm.`,
  ],
  ...(hardware?.actuators ?? []).flatMap((one) => [
    one.share > 1.0001 && ["actuator", `Actuators of ${words(one.name)} are used at ${figure(100 * one.share, 3)} %.`],
    one.winding_c !== null && one.winding_c > FULL * one.winding_limit_c && [
      "temperature",
      `Windings of ${words(one.name)} reach ${figure(one.winding_c, 3)} °C of at most ${figure(one.winding_limit_c)} °C.`,
    ],
  ]),
];

// The largest component of the moment on a hand, beside the bound of the load.
const handRemark = (agent, { wrenches }, bound) => {
  const moments = Object.entries(wrenches).flatMap(([contact, wrench]) =>
    contact.endsWith("hand") ? wrench.slice(3).map(Math.abs) : [],
  );
  const most = Math.max(0, ...moments);
  if (bound === null || most < FULL * bound) return null;
  return ["hand", `${agentName(agent)}: moment on a hand ${figure(most, 3)} N m of at most ${figure(bound)} N m.`];
};

const idleRemark = (agent, { torques_n_m: torques }) => {
  const most = Math.max(...Object.values(torques).map(Math.abs));
  const idle = Object.keys(torques).filter((joint) => Math.abs(torques[joint]) <= NOTHING * most);
  const noun = idle.length === 1 ? "joint carries" : "joints carry";
  return idle.length ? ["idle", `${agentName(agent)}: ${idle.length} of ${Object.keys(torques).length} ${noun} nothing: ${listed(idle.map(called))}.`] : null;
};

const priceText = (limit) => {
  const [size, unit] = stepOf(limit);
  const change = limit.price_n_m * size;
  return `${/^\d/.test(unit) ? unit : `1 ${unit}`} ${change < 0 ? "more" : "less"} saves ${figure(Math.abs(change), 2)} N m of effort`;
};

const limitRemark = (limits) => {
  if (!limits.length) return null;
  const cost = (limit) => Math.abs(limit.price_n_m * stepOf(limit)[0]);
  const dear = limits.reduce((one, other) => (cost(other) > cost(one) ? other : one));
  const whose = dear.agent ? `${agentName(dear.agent).toLowerCase()}'s ` : "";
  return ["limits", `${countable(limits.length, "limit")} active, the costliest: ${whose}${limitText(dear)}; ${priceText(dear)}.`];
};

const caseRemarks = (design, at) => {
  const [posture, gap, effort] = [postureAt(design, at), clearanceAt(design, at), effortAt(design, at)];
  const fallbacks = outcomeAt(design, at)?.fallbacks ?? 0;
  const bound = content.bodies.payloads[at.payload].hand_moment_n_m;
  const agents = Object.entries(posture?.agents ?? {});
  return [
    fallbacks > 0 && ["fallback", `The native solver found no posture here; IPOPT solved ${countable(fallbacks, "time")} instead.`],
    gap && gap.distance_m < NEAR && ["bodies", `${clearanceText(gap)}.`],
    effort?.back_n > FULL * effort?.back_limit_n && [
      "back",
      `Back: L5/S1 is compressed by ${kilonewtons(effort.back_n)}; NIOSH's limit is ${kilonewtons(effort.back_limit_n)}.`,
    ],
    ...agents.map(([agent, one]) => handRemark(agent, one, bound)),
    limitRemark(limitsAt(design, at)),
    ...agents.map(([agent, one]) => idleRemark(agent, one)),
  ];
};

const remarkList = (row, design) => {
  const list = element("ul", { class: "notes", id: "remarks" });
  const title = element("h3", { text: "Where to look" });
  const box = element("div", {}, title, list);
  const draw = () => {
    const found = [...designRemarks(row, design), ...caseRemarks(design, shownCase())].filter(Boolean);
    box.hidden = byId("to-remarks").hidden = !found.length;
    byId("to-remarks").textContent = `where to look: ${found.length}`;
    byId("to-remarks").onclick = () => box.scrollIntoView({ block: "center" });
    list.replaceChildren(...found.map(([kind, text]) => element("li", { "data-remark": kind, text })));
  };
  return { box, draw };
};
