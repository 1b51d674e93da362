// How results spread over people drawn from the measured distribution.

const overPeople = content.spread;
const spreadOf = new Map((overPeople?.designs ?? []).map((one) => [one.id, one]));

// In how many of the samples a quantity exists is said where it is not all of them.
const momentsText = (moments, samples) => {
  if (!moments) return "–";
  const some = moments.samples < samples ? ` (${moments.samples} of ${samples})` : "";
  const spreads = moments.deviation !== null && moments.deviation > 1e-6 * Math.abs(moments.mean);
  return figure(moments.mean) + (spreads ? ` ± ${figure(moments.deviation, 2)}` : "") + some;
};

// What a solver leaves open is no difference.
const differenceText = (quantity, samples) => {
  const { difference } = quantity ?? {};
  if (!difference) return "–";
  const size = Math.abs(difference.mean) + (difference.deviation ?? 0);
  return size <= 1e-6 * Math.abs(quantity.mean) ? "0" : momentsText(difference, samples);
};

// Mean and deviation of a quantity: over sampled people, else over the problem's own; nothing where there is one.
const overPeopleOf = (number, name) => {
  const sampled = spreadOf.get(number)?.quantities[name];
  if (sampled && sampled.deviation !== null) return sampled;
  const [mean, deviation] = content.designs[number]?.people[name] ?? [];
  return mean === undefined ? null : { mean, deviation };
};

const peopleRow = (own) =>
  element(
    "tr",
    { "data-people": `${own.id}`, onclick: () => pick(own.id) },
    element(
      "td",
      { class: "number" },
      element("button", { type: "button", class: "open", text: `${own.id}`, "aria-label": `Show design ${own.id}` }),
    ),
    element("td", { class: "number", text: `${own.on_front} of ${overPeople.samples}` }),
    ...resultAxes.map((axis) =>
      element("td", { class: "number", text: momentsText(own.quantities[axis.name], own.samples) }),
    ),
  );

const startPeople = () => {
  if (!overPeople) return;
  byId("people-section").hidden = false;
  byId("people-hint").textContent =
    `Mean ± standard deviation over ${overPeople.samples} people drawn from the measured distribution, the same for all designs; and in how many of the samples none of these designs dominates it.`;
  const heads = [["Design"], ["On the front"], ...resultAxes.map((axis) => [label(axis)])];
  byId("people").append(
    element("table", {}, headRow(heads), element("tbody", {}, ...overPeople.designs.map(peopleRow))),
  );
};

// The section of the card; nothing for a design that was not sampled.
const peopleSection = (number) => {
  const own = spreadOf.get(number);
  if (!own) return null;
  const compared = overPeople.reference !== null && overPeople.reference !== number;
  const heads = [["Quantity", ""], ["People"]];
  if (compared) heads.push([`Less that of design ${overPeople.reference}`], ["Better"]);
  const rows = resultAxes.map((axis) => {
    const quantity = own.quantities[axis.name];
    const cells = [momentsText(quantity, own.samples)];
    const { better, samples } = quantity?.difference ?? {};
    if (compared) cells.push(differenceText(quantity, own.samples), better === undefined ? "–" : `in ${better} of ${samples}`);
    return element(
      "tr",
      {},
      element("th", { scope: "row", text: capital(label(axis)) }),
      ...cells.map((text) => element("td", { class: "number", text })),
    );
  });
  const caption = element("caption", {
    text: `Mean ± standard deviation over ${own.samples} people drawn from the measured distribution; feasible in ${own.feasible}. Differences are those beside the same person.`,
  });
  const table = element("table", { class: "bill" }, caption, headRow(heads), element("tbody", {}, ...rows));
  return fold("People", `on the front in ${own.on_front} of ${overPeople.samples} samples`, table);
};
