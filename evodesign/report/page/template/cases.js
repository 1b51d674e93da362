// Who holds what, how high: the case that is shown, its controls, and all cases of a design at a glance.

const severalPairs = content.people.length * content.payloads.length > 1;

const caseAt = (person, payload, stop) => ({
  person: content.people[person],
  payload: content.payloads[payload],
  height: stops[stop]?.height_m,
  stop,
});
const shownCase = () => caseAt(state.person, state.payload, state.height);

const taskTexts = stops.map(({ task }) => JSON.stringify(task));
const taskNames = Object.fromEntries(stops.map(({ name }, stop) => [taskTexts[stop], name]));

// Whether an outcome or postures of the log are of a case; a name that is not there is empty.
const isOf = ({ case: { person = "", payload = "", task } }, at) =>
  JSON.stringify(task) === taskTexts[at.stop] && person === at.person && payload === at.payload;
const outcomeAt = (design, at) => design.cases.find((one) => isOf(one, at));
const postureAt = (design, at) =>
  design.postures.find((one) => isOf(one, at))?.instants[stops[at.stop].moment];

// Height of the load [m] in a posture.
const loadHeight = (posture, at) => posture?.load_height_m ?? at.height;

// The two bodies that are nearest in a posture; nothing if the page does not know.
const clearanceAt = (design, at) => design.clearances[design.postures.findIndex((one) => isOf(one, at))];
const clearanceText = ({ first: one, second: other, distance_m: distance }, [first, second] = [one, other].map(inWords)) =>
  distance < -1e-4
    ? `${capital(first)} and ${second} overlap by ${figure(-1e3 * distance, 2)} mm`
    : `Nearest bodies: ${first} and ${second}, ${figure(1e3 * Math.max(distance, 0), 2)} mm apart`;

const pairText = (at) => [at.person, at.payload].filter(Boolean).join(", ");
const caseText = (at) => [pairText(at), stopText(at.stop)].filter(Boolean).join(", ");

const showCase = (person, payload, height) => {
  const samePair = person === state.person && payload === state.payload;
  Object.assign(state, { person, payload, height });
  tell(samePair ? "height" : "pair");
};

// Choosing among people, or among loads; nothing where there is one.
const chooser = (id, title, names, key) => {
  if (names.length < 2) return null;
  const select = element(
    "select",
    { id },
    ...names.map((name, index) => element("option", { value: index, text: name })),
  );
  select.addEventListener("change", () => {
    const wanted = { ...state, [key]: Number(select.value) };
    showCase(wanted.person, wanted.payload, wanted.height);
  });
  const show = () => (select.value = state[key]);
  return { box: element("label", { for: id, text: title }, select), show };
};

const pairControl = () => {
  const choosers = [
    chooser("person", "Person", content.people, "person"),
    chooser("payload", "Load", content.payloads, "payload"),
  ].filter(Boolean);
  return {
    box: choosers.length
      ? element("div", { class: "choices pair-choices" }, ...choosers.map(({ box }) => box))
      : null,
    show: () => choosers.forEach(({ show }) => show()),
  };
};

const NORMS = { robot: "robot_torque_norm", human: "human_torque_norm" };

// A cell: the torque norm of a case, shaded by its share of the largest; a click shows the case.
const caseCell = (design, agent, most, indices) => {
  const at = caseAt(...indices);
  const outcome = outcomeAt(design, at);
  const norm = outcome?.[NORMS[agent]] ?? null;
  const share = norm === null ? 0 : Math.round((60 * norm) / (most || 1));
  const current = JSON.stringify(at) === JSON.stringify(shownCase());
  const button = element("button", {
    type: "button",
    text: norm === null ? (outcome?.status ?? "unknown") : exact(norm, 3),
    title: caseText(at),
    "aria-label": `${caseText(at)}: ${norm === null ? (outcome?.status ?? "unknown") : `${exact(norm, 3)} N m`}`,
    "aria-pressed": current ? "true" : "false",
    style: `background:color-mix(in srgb, var(--${agent === "robot" ? "accent" : "second"}) ${share}%, var(--surface))`,
    onclick: () => showCase(...indices),
  });
  return element("td", {}, button);
};

// The first stop of every task: a lift has one outcome.
const taskStops = everyStop.filter((stop) => stops[stop].moment === 0);

const caseTable = (design, agent) => {
  const norms = design.cases.map((one) => one[NORMS[agent]] ?? 0);
  const most = Math.max(...norms, 0);
  const heads = [
    content.people.length > 1 ? "Person" : null,
    content.payloads.length > 1 ? "Load" : null,
    ...taskStops.map((stop) => (isLift(stop) ? stops[stop].name : stopText(stop))),
  ].filter(Boolean);
  const rows = content.people.flatMap((human, person) =>
    content.payloads.map((payload, load) =>
      element(
        "tr",
        { class: load === 0 ? "first" : "" },
        ...(human ? [element("th", { scope: "row", text: human })] : []),
        ...(payload ? [element("th", { scope: "row", text: payload })] : []),
        ...taskStops.map((stop) => caseCell(design, agent, most, [person, load, stop])),
      ),
    ),
  );
  return element(
    "table",
    { class: "cases" },
    element("thead", {}, element("tr", {}, ...heads.map((text) => element("th", { scope: "col", text })))),
    element("tbody", {}, ...rows),
  );
};

// The section of all cases; null where a case is its height.
const caseSection = (design) => {
  if (!severalPairs) return null;
  const place = element("div", { class: "scroll-cases" });
  const roles = Object.keys(NORMS).filter((role) => role !== "human" || hasPeople());
  let [whose] = roles;
  const draw = () => {
    const focused = place.contains(document.activeElement);
    place.replaceChildren(caseTable(design, whose));
    if (focused) place.querySelector('[aria-pressed="true"]')?.focus({ preventScroll: true });
  };
  const choose = (role) => {
    whose = role;
    draw();
  };
  const whoseTorques = agentSegments("cases", choose, roles, (role) => (role === "robot" ? "Robot" : "Person"));
  const section = element(
    "details",
    { open: true },
    element(
      "summary",
      { text: "All cases" },
      element("small", { text: `${design.cases.length}` }),
    ),
    element("div", { class: "choices", style: "margin-top:10px" }, whoseTorques),
    element("p", { class: "hint", text: "|torque| [N m] of each case; a click shows its posture." }),
    place,
  );
  return { section, draw };
};
