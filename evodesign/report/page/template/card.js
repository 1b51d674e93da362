// The card of the chosen design: its objectives, its postures, its parameters.

const against = (axis, row) => {
  const number = comparing() ? state.beside : unscaledMark?.number;
  const reference = axis.column[rowOf.get(number)] ?? null;
  if (reference === null || axis.column[row] === null || number === points.number[row]) return "";
  return `${comparing() ? `design ${number}:` : "unscaled"} ${exact(reference)}`;
};

const peopleText = (number, name) => {
  const spread = overPeopleOf(number, name);
  return spread ? `people ${figure(spread.mean, 3)} ± ${figure(spread.deviation, 2)}` : "";
};

// By eighths of a turn, from forwards to the robot's left.
const DIRECTIONS = ["forwards", "forwards to the left", "to the left", "backwards to the left", "backwards", "backwards to the right", "to the right", "forwards to the right"];

const weakestText = (number, name) => {
  const weakest = content.designs[number]?.weakest?.[name];
  if (!weakest) return "";
  const [pushed, place] = [DIRECTIONS[Math.round(weakest.direction_deg / 45) % 8], weakest.moment ? ` at ${weakest.moment}` : ""];
  return `weakest pushed ${pushed}${place}${weakest.reason ? `: ${weakest.reason}` : ""}`;
};

const worth = (row) =>
  element(
    "dl",
    { class: "worth" },
    ...resultAxes.map((axis) => {
      const [value, constraint] = [axis.column[row], constraintOn(axis.name)];
      return element(
        "div",
        {},
        element("dt", { text: `${capital(words(axis.name))} ${arrowOf[axis.sense]}`.trim() }),
        element(
          "dd",
          { [isObjective(axis.name) ? "data-objective" : "data-constraint"]: axis.name },
          exact(value),
          element("small", { text: value === null ? " no value" : ` ${unitText(axis.unit)}` }),
          element("span", { class: "against", text: against(axis, row) }),
          element("span", {
            ...{ class: "against", "data-spread": axis.name, text: peopleText(points.number[row], axis.name) },
            title: "Mean and standard deviation over the people of the problem, or over those that were sampled",
          }),
          element("span", { class: "against", "data-weakest": axis.name, text: weakestText(points.number[row], axis.name) }),
          constraint
            ? element("span", {
                class: isBeyond(constraint, value) ? "against beyond" : "against",
                text: boundsText(constraint),
              })
            : "",
        ),
      );
    }),
  );

const cardHead = (row) => {
  const number = points.number[row];
  const kind = { front: "on the front", feasible: "dominated", infeasible: "not feasible" }[points.kind[row]];
  const labels = [...new Set(marksOf(number).map((mark) => `${symbolOf[mark.kind]} ${mark.label}`)), kind];
  const step = (text, name, by) =>
    element("button", { type: "button", class: "quiet", "aria-label": name, text, onclick: () => walk(by) });
  const head = element(
    "div",
    {},
    element(
      "div",
      { class: "heading" },
      element("h2", { id: "card-title", text: `Design ${number}` }),
      element(
        "span",
        { class: "choices" },
        besideButton(number),
        ...(hasFront
          ? [step("‹", "Previous design of the front", -1), step("›", "Next design of the front", 1)]
          : []),
      ),
    ),
    element("p", { class: "labels" }, labels.join(" · "), element("button", { type: "button", class: "open", id: "to-remarks", hidden: true })),
    worth(row),
    reachFigure(row),
  );
  if (points.reason[row])
    head.append(
      element("p", {
        class: "plain",
        text:
          capital(points.reason[row]) +
          (points.violation[row] === null ? "" : ` (violation ${figure(points.violation[row])}${constraints.length ? "" : " m"})`),
      }),
    );
  return head;
};

const whyNoPosture = (row) => {
  if (!content.bodies) return "The robot cannot be drawn: see the notes at the top.";
  if (points.kind[row] === "front")
    return "The postures of this design are not in this page: see the notes at the top.";
  if (points.kind[row] === "infeasible")
    return `The log keeps no postures of a design that is not feasible. evodesign report RUN --designs ${points.number[row]} solves anew what can be solved.`;
  return `The log keeps postures of designs that nothing before them had beaten; this one was beaten when it arrived. evodesign report RUN --designs ${points.number[row]} solves it anew.`;
};

const NOTHING_KNOWN = { cases: [], postures: [], clearances: [], efforts: [], people: {}, gradients: {}, links: {}, joints: {}, hardware: null };

// What the card shows now: how to draw it again, and how to show another height or case.
const shown = { redraw: () => {}, height: () => {} };

const titleOf = (details) => details.querySelector("summary").firstChild.textContent;

// Fill the card; sections that the reader folded stay folded.
const fillCard = (parts) => {
  const card = byId("card");
  const sections = () => [...card.querySelectorAll("details")];
  const folded = new Map(sections().map((one) => [titleOf(one), one.open]));
  for (const plot of card.querySelectorAll(".joint-plot"))
    Promise.allSettled([plot.drawn]).then(() => Plotly.purge(plot)); // plotly fails if it still draws there
  card.replaceChildren(...parts.filter(Boolean));
  for (const one of sections()) one.open = folded.get(titleOf(one)) ?? one.open;
  card.scrollTop = 0;
};

const drawWithoutPostures = (row) => {
  shownScene = null;
  const why = element("div", {}, element("p", { class: "plain", text: whyNoPosture(row) }));
  const files = downloads(row, content.designs[state.selected] ?? NOTHING_KNOWN);
  fillCard([besideHead(), cardHead(row), why, besideSection(), peopleSection(state.selected), fold("Parameters", `${parameters.length}`, parameterTable(row)), files]);
  Object.assign(shown, { redraw: () => {}, height: () => {} });
};

const drawWithPostures = (row, design) => {
  const height = heightControl(design);
  const torques = torqueSection(state.selected, design);
  const motion = motionSection(design);
  const cases = caseSection(design);
  const limits = limitSection(design);
  const effort = effortSection(design);
  const wrenches = element("div");
  const remarks = remarkList(row, design);
  const mass = massOf(treeOf("robot", design));
  fillCard([
    besideHead(),
    cardHead(row),
    hasWebgl ? theStage() : withoutStage(),
    height.box,
    remarks.box,
    besideSection(),
    downloads(row, design),
    cases?.section,
    peopleSection(state.selected),
    fold("Parameters", `${parameters.length}`, parameterTable(row)),
    torques.section,
    motion?.section,
    limits?.section,
    effort?.section,
    ...hardwareSections(design),
    fold("Masses", `robot ${figure(mass)} kg`, massTable(design)),
    fold("Contact wrenches", "", wrenches),
    sensitivities(design),
  ]);
  const redraw = () => {
    torques.draw();
    motion?.draw();
  };
  redraw();
  let task = taskTexts[state.height];
  const showHeight = (moving) => {
    height.show();
    remarks.draw();
    if (task !== taskTexts[state.height]) motion?.draw();
    task = taskTexts[state.height];
    cases?.draw();
    limits?.draw();
    effort?.draw();
    const posture = postureAt(design, shownCase());
    const missing = () =>
      element("p", { class: "plain", text: `No posture ${severalPairs ? "in this case" : "at this height"}.` });
    wrenches.replaceChildren(posture ? wrenchTable(posture) : missing());
    if (hasWebgl) showPosture(state.selected, design, moving);
  };
  Object.assign(shown, { redraw, height: showHeight });
  showHeight(false);
};

// On a screen too narrow for two columns the card is a sheet over the page, opened by choosing a design.
const stacked = window.matchMedia("(max-width: 900px)");
let openedFrom = null;

const isOpen = () => byId("card").classList.contains("drawn-up");

const showSheet = (open) => {
  byId("card").classList.toggle("drawn-up", open);
  byId("open-card").setAttribute("aria-expanded", String(open));
  byId("open-card").textContent = `${open ? "Close" : "Show"} design ${state.selected}`;
};

const openSheet = () => {
  if (!stacked.matches || isOpen()) return;
  openedFrom = document.activeElement;
  showSheet(true);
  byId("card").focus({ preventScroll: true });
};

const closeSheet = () => {
  if (!isOpen()) return;
  showSheet(false);
  (openedFrom?.isConnected && openedFrom !== document.body ? openedFrom : byId("open-card")).focus({ preventScroll: true });
};

const startSheet = () => {
  byId("open-card").hidden = false;
  byId("open-card").addEventListener("click", () => (isOpen() ? closeSheet() : openSheet()));
  document.querySelector(".skip").addEventListener("click", openSheet);
  document.addEventListener("keydown", (event) => event.key === "Escape" && closeSheet());
  stacked.addEventListener("change", () => showSheet(false));
};

const pick = (number) => {
  select(number);
  openSheet();
};

const drawCard = () => {
  const row = rowOf.get(state.selected);
  if (row === undefined) return;
  showSheet(isOpen());
  const design = content.designs[state.selected] ?? NOTHING_KNOWN;
  if (content.bodies !== null && design.postures.length > 0) drawWithPostures(row, design);
  else drawWithoutPostures(row);
};

const startCard = () => {
  if (points.number.length === 0) {
    const title = element("h2", { id: "card-title", text: "No design yet" });
    const text = "Designs appear here as soon as the run holds an evaluation.";
    byId("card").append(element("div", {}, title, element("p", { class: "plain", text })));
    return;
  }
  state.height = stops.length > 1 ? 1 : 0;
  state.person = Math.floor(content.people.length / 2);
  state.payload = Math.floor(content.payloads.length / 2);
  startSheet();
  on("selected", drawCard);
  on("height", () => shown.height(true));
  on("pair", () => {
    shown.redraw();
    shown.height(true);
  });
  on("theme", () => {
    shown.redraw();
    shown.height(false);
  });
};
