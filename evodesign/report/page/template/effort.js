// What the posture that is shown does to the person's back and muscles, and how an observer would score it.

const effortAt = (design, at) => design.efforts[design.postures.findIndex((one) => isOf(one, at))];

const kilonewtons = (newtons) => `${figure(newtons / 1000, 2)} kN`;

const holdingText = ({ seconds, longer, tires }) =>
  `${longer ? "more than " : ""}${seconds < 120 ? `${seconds} s` : `${Math.round(seconds / 60)} min`}, until ${called(tires)} tires`;

const effortRows = (effort) => [
  effort.back_n !== null && [
    "Compression of L5/S1",
    `${kilonewtons(effort.back_n)}, ${effort.back_n > effort.back_limit_n ? "above" : "below"} NIOSH's limit of ${kilonewtons(effort.back_limit_n)}`,
    effort.back_n > effort.back_limit_n,
  ],
  effort.shear_n !== null && ["Shear of L5/S1", kilonewtons(effort.shear_n)],
  ["Torques that the load adds", `${figure(effort.load_n_m, 3)} N m`],
  effort.seconds !== null && ["Can be held", holdingText(effort)],
  effort.rula !== null && ["RULA (1 to 7)", `${effort.rula}`],
  effort.reba !== null && ["REBA (1 to 15)", `${effort.reba}`],
];

const effortTable = (effort) =>
  element(
    "table",
    { class: "bill" },
    element("caption", {
      text: "In a lift at the moment of the person's largest torques. Torques: against empty hands in the same posture. Times and scores are those of published curves and worksheets.",
    }),
    element(
      "tbody",
      {},
      ...effortRows(effort)
        .filter(Boolean)
        .map(([name, text, beyond]) =>
          element(
            "tr",
            { "data-effort": name },
            element("th", { scope: "row", text: name }),
            element("td", { class: beyond ? "beyond" : "", text }),
          ),
        ),
    ),
  );

// The section of the card; nothing where the run's problem does not know the people.
const effortSection = (design) => {
  if (!design.efforts.length) return null;
  const place = element("div");
  const draw = () => {
    const effort = effortAt(design, shownCase());
    place.replaceChildren(...(effort ? [effortTable(effort)] : []));
  };
  return { section: fold("The person's back and effort", "", place), draw };
};
