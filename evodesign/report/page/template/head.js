// The page's head and foot: what this run is, in words and figures.

const countable = (count, noun) => `${count} ${noun}${count === 1 ? "" : "s"}`;

const duration = (seconds) => {
  if (seconds < 90) return `${figure(seconds, 2)} s`;
  if (seconds < 5400) return `${figure(seconds / 60, 2)} min`;
  return `${figure(seconds / 3600, 3)} h`;
};

const NOTES_SHOWN = 2;

const bestFigure = (objective, axis) => {
  const mark = content.marks.find((one) => one.kind === "best" && one.label.endsWith(words(objective.name)));
  if (!mark) return null;
  const value = axis.column[rowOf.get(mark.number)];
  const before = unscaledMark ? axis.column[rowOf.get(unscaledMark.number)] : null;
  return [
    capital(mark.label),
    exact(value),
    ` ${unitText(objective.unit)}`,
    before === null ? "" : `unscaled ${exact(before)}`,
  ];
};

const startHead = () => {
  const { facts } = content;
  document.title = `${facts.problem}: evodesign report`;
  byId("title").textContent = facts.problem;
  byId("lead").textContent =
    `${countable(objectives.length, "objective")}${constraints.length ? ` and ${countable(constraints.length, "constraint")}` : ""} over ${countable(parameters.length, "parameter")}, searched by ${facts.algorithm} with a population of ${facts.population}, seed ${facts.seed}.`;
  const share = facts.evaluations ? percent(facts.feasible / facts.evaluations) : "–";
  const figures = [
    ["Evaluated", `${facts.evaluations}`, " designs", `of a budget of ${facts.budget}`],
    ["Feasible", share, "", countable(facts.feasible, "design")],
    [
      "On the front",
      `${facts.front}`,
      facts.front === 1 ? " design" : " designs",
      facts.front ? "beaten by none" : "",
    ],
    ...(objectives.length <= 4
      ? objectives.map((objective, index) => bestFigure(objective, axes[index])).filter(Boolean)
      : []),
  ];
  byId("figures").append(
    ...figures.map(([name, value, unit, aside]) =>
      element(
        "div",
        {},
        element("dt", { text: name }),
        element(
          "dd",
          {},
          value,
          element("small", { text: unit }),
          element("span", { class: "against", text: aside }),
        ),
      ),
    ),
  );
  const notes = byId("notes");
  notes.hidden = content.notes.length === 0;
  const items = content.notes.map((note) => element("li", { text: capital(inWords(note)) }));
  notes.append(...items.slice(0, NOTES_SHOWN));
  if (items.length > NOTES_SHOWN)
    byId("more-notes").append(
      element("summary", { text: `${countable(items.length - NOTES_SHOWN, "more note")}` }),
      element("ul", { class: "notes" }, ...items.slice(NOTES_SHOWN)),
    );
  byId("more-notes").hidden = items.length <= NOTES_SHOWN;
  const listed = [
    ["Directory", facts.directory],
    ["Started", facts.started || "–"],
    ["Computing time of all evaluations", duration(facts.seconds)],
    [
      "Versions",
      Object.entries(facts.versions)
        .map(([name, version]) => `${name} ${version}`)
        .join(", ") || "–",
    ],
    ["Commit", facts.git ?? "–"],
  ];
  byId("facts").append(
    ...listed.flatMap(([name, value]) => [element("dt", { text: name }), element("dd", { text: value })]),
  );
  byId("problem").textContent = facts.problem_text;
};
