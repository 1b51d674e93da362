// Why designs failed, the most frequent cause first.

const startFailures = () => {
  const place = byId("failures");
  if (content.failures.length === 0) {
    place.append(
      element("p", {
        class: "plain",
        text: content.facts.evaluations ? "Every evaluated design is feasible." : "No evaluation yet.",
      }),
    );
    return;
  }
  const most = content.failures[0].count;
  const body = content.failures.map((failure) =>
    element(
      "tr",
      {},
      element("th", { scope: "row", class: "cause", text: capital(failure.cause) }),
      element("td", { class: "number", text: `${failure.count}` }),
      element(
        "td",
        { class: "share" },
        element("div", {
          class: "bar",
          style: `width:${(100 * failure.count) / most}%`,
          "aria-hidden": "true",
        }),
      ),
      element("td", { class: "number", text: percent(failure.count / content.facts.evaluations) }),
      element("td", { class: "example", text: `Design ${failure.example}: ${failure.reason}` }),
    ),
  );
  const heads = [
    ["Cause", ""],
    ["Designs", "number"],
    ["", "share"],
    ["of all", "number"],
    ["First example", "example"],
  ];
  place.append(
    element(
      "table",
      {},
      element(
        "thead",
        {},
        element("tr", {}, ...heads.map(([text, kind]) => element("th", { scope: "col", class: kind, text }))),
      ),
      element("tbody", {}, ...body),
    ),
  );
};
