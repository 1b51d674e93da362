// The limits that hold the posture that is shown, and what each of them costs.

const LIMIT_STEPS = { m: [0.01, "cm"], rad: [Math.PI / 180, "degree"], 1: [0.01, "0.01"] };
const stepOf = (limit) => LIMIT_STEPS[limit.unit] ?? [1, limit.unit || "unit"];

const limitsAt = (design, at) => design.postures.find((one) => isOf(one, at))?.limits ?? [];

const limitText = (limit) => {
  const [size, unit] = stepOf(limit);
  const value = figure(limit.unit === "1" ? limit.value : limit.value / size, 3);
  const whose = limit.part ? `${limit.name} of ${inWords(limit.part)}` : limit.name;
  const shown = limit.unit === "1" ? value : `${value} ${unit === "degree" ? "degrees" : unit}`;
  return `${whose}, at ${limit.at_most ? "most" : "least"} ${shown}`;
};

const limitRow = (limit) => {
  const [size, unit] = stepOf(limit);
  return element(
    "tr",
    { "data-limit": limit.name, title: limit.key ?? "" },
    element("th", { scope: "row", text: capital(limitText(limit)) }),
    element("td", { text: limit.agent ? agentName(limit.agent) : everyAgent().length > 2 ? "All" : "Both" }),
    element("td", { class: "number", text: figure(limit.price_n_m * size, 3) }),
    element("td", { text: unit }),
  );
};

const limitTable = (limits) =>
  element(
    "table",
    { class: "bill" },
    element("caption", {
      text: "By how much the effort (root of the weighted sum of squared torques) changes with a step more of each limit, to first order: negative where a larger value saves. The price of a pair of joints is that of both.",
    }),
    headRow([["Limit", ""], ["Whose", ""], ["Effort [N m]"], ["per", ""]]),
    element("tbody", {}, ...limits.map(limitRow)),
  );

// The section of the card; nothing for designs whose log holds no limits.
const limitSection = (design) => {
  if (!design.postures.some((one) => one.limits?.length)) return null;
  const place = element("div");
  const draw = () => {
    const limits = limitsAt(design, shownCase());
    const none = () => element("p", { class: "plain", text: "No limit holds this posture." });
    place.replaceChildren(limits.length ? limitTable(limits) : none());
  };
  return { section: fold("Active limits", "", place), draw };
};
