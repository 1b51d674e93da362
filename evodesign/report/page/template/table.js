// The designs as a table: for the keyboard, for screen readers, and for exact figures.

const TABLE_ROWS = 300;
const sorting = { axis: 0, rising: true };

const drawTable = () => {
  const wanted = (hasFront ? frontRows : lineRows()).filter(inside);
  const column = sorting.axis === null ? points.number : axes[sorting.axis].column;
  const order = [...wanted].sort(
    (a, b) => (sorting.rising ? 1 : -1) * ((column[a] ?? Infinity) - (column[b] ?? Infinity)),
  );
  const shown = order.slice(0, TABLE_ROWS);
  const note =
    shown.length < order.length ? `, the first ${shown.length} of ${order.length} in this order` : "";
  byId("table-hint").textContent = wanted.length
    ? `${hasFront ? "Designs of the front" : "Designs"}${filtered() ? " inside the brushes" : ""}${note}. A column's name sorts by it.`
    : "No design to list.";
  const sort = (axis) => () => {
    sorting.rising = sorting.axis === axis ? !sorting.rising : true;
    sorting.axis = axis;
    drawTable();
  };
  const head = (text, axis) => {
    const sorted = sorting.axis === axis ? (sorting.rising ? "ascending" : "descending") : null;
    const arrow = sorted ? (sorting.rising ? " ▴" : " ▾") : "";
    return element(
      "th",
      { scope: "col", class: "number", "aria-sort": sorted },
      element("button", { type: "button", text: text + arrow, onclick: sort(axis) }),
    );
  };
  const columns = resultAxes;
  const cells = (row) =>
    columns.map((axis) => element("td", { class: "number", text: exact(axis.column[row]) }));
  const violation = constraints.length ? "Violation" : "Violation [m]";
  const extra = hasFront ? [] : [element("th", { scope: "col", class: "number", text: violation })];
  const body = shown.map((row) => {
    const number = points.number[row];
    return element(
      "tr",
      { "aria-current": number === state.selected ? "true" : null, onclick: () => pick(number) },
      element(
        "td",
        { class: "number" },
        element("button", {
          type: "button",
          class: "open",
          text: `${number}`,
          "aria-label": `Show design ${number}`,
        }),
      ),
      ...cells(row),
      ...(hasFront ? [] : [element("td", { class: "number", text: figure(points.violation[row]) })]),
      element("td", {
        class: "marked",
        text: marksOf(number)
          .map((mark) => mark.label)
          .join(", "),
      }),
    );
  });
  const table = element(
    "table",
    {},
    element(
      "thead",
      {},
      element(
        "tr",
        {},
        head("Design", null),
        ...columns.map((axis, index) => head(label(axis), index)),
        ...extra,
        element("th", { scope: "col", text: "Marked as" }),
      ),
    ),
    element("tbody", {}, ...body),
  );
  byId("table").hidden = wanted.length === 0;
  byId("table").replaceChildren(table);
};

const markTableRow = () => {
  for (const row of byId("table").querySelectorAll("tbody tr")) {
    const current = row.querySelector(".open").textContent === String(state.selected);
    if (current) row.setAttribute("aria-current", "true");
    else row.removeAttribute("aria-current");
  }
};

const startTable = () => {
  drawTable();
  on("filter", drawTable);
  on("selected", markTableRow);
};
