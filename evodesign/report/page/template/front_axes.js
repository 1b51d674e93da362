// Which quantities are the axes of the front, and what lies outside of them.

const axisChoice = (text, key) => {
  const option = (axis) => {
    const index = frontAxes.indexOf(axis);
    return element("option", {
      ...{ value: index, text: words(axis.name).replace(".", " "), selected: drawnIn[key] === index },
    });
  };
  const group = (name, wanted) => element("optgroup", { label: name }, ...wanted.map(option));
  const choice = element(
    "select",
    {
      id: `axis-${key}`,
      onchange: () => {
        drawnIn[key] = Number(choice.value);
        drawnIn.everything = 0;
        drawFront();
        tell("view");
      },
    },
    ...(key === "colour"
      ? [element("option", { value: NO_COLOUR, text: "none", selected: drawnIn.colour === NO_COLOUR })]
      : []),
    group("Results", frontAxes.filter((axis) => !axis.isParameter)),
    group("Parameters", frontAxes.filter((axis) => axis.isParameter)),
  );
  return element("label", { text }, choice);
};

const frontChoices = () => {
  const form = byId("front-choices");
  const segments = element("span", { class: "segments", role: "radiogroup", "aria-label": "Dimensions" });
  for (const [text, solid] of [
    ["2D", false],
    ["3D", true],
  ]) {
    const radio = element("input", {
      type: "radio",
      name: "dimensions",
      id: `front-${text}`,
      checked: !solid,
      disabled: solid && !hasWebgl,
      onchange: () => {
        turnSolid(solid);
        tell("view");
      },
    });
    segments.append(element("label", {}, radio, text));
  }
  form.append(
    axisChoice("across", "across"),
    axisChoice("up", "up"),
    axisChoice("colour, depth", "colour"),
    segments,
  );
};

// Draw and offer the axes that are set.
const showAxes = (solid) => {
  for (const key of ["across", "up", "colour"]) byId(`axis-${key}`).value = drawnIn[key];
  byId(solid ? "front-3D" : "front-2D").checked = true;
  turnSolid(solid);
};

// How many designs lie outside the axes as they stand, and how many are beyond the scale of colours.
const sayOutside = () => {
  const { xaxis, yaxis, scene } = byId("front")._fullLayout;
  const drawn = drawnIn.solid ? scene : { xaxis, yaxis };
  const shown = [
    [drawnIn.across, drawn.xaxis],
    [drawnIn.up, drawn.yaxis],
    ...(drawnIn.solid ? [[thirdIndex(), drawn.zaxis]] : []),
  ].map(([index, axis]) => [frontAxes[index].column, ...axis.range]);
  const beyond = (row) =>
    shown.some(([column, a, b]) => column[row] < Math.min(a, b) || column[row] > Math.max(a, b));
  const onFront = frontRows.filter(beyond).length;
  const behind = dominatedRows.filter((row) => (!filtered() || inside(row)) && beyond(row)).length;
  const parts = [onFront && `${onFront} of the front`, behind && `${behind} behind it`].filter(Boolean);
  const third = drawnIn.solid ? undefined : frontAxes[drawnIn.colour];
  const [low, high] = third ? zoomed(third) : [];
  const coloured = third ? frontRows.filter((row) => third.column[row] < low || third.column[row] > high) : [];
  byId("scale").hidden = !third || !narrow.matches;
  if (third) {
    const [from, to] = third.sense === "minimise" ? [high, low] : [low, high];
    byId("scale").replaceChildren(`${capital(words(third.name))}: ${figure(from, 3)} `, element("i"), ` ${withUnit(Number(to.toPrecision(3)), third.unit)}`);
  }
  const sentences = [
    parts.length ? `Outside the axes: ${parts.join(" and ")}.` : "",
    coloured.length ? `Beyond the scale of colours: ${coloured.length}.` : "",
  ].filter(Boolean);
  byId("outside").textContent = sentences.join(" ");
  byId("show-all").hidden = sentences.length === 0;
  byId("show-all").onclick = () => {
    drawnIn.everything += 1;
    drawFront();
  };
};
