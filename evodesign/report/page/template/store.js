// What the page knows, what is chosen in it, and who wants to be told.

// Bytes in the letters of base85 (those of git), four to five letters.
const LETTERS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz!#$%&()*+-;<=>?@^_`{|}~";
const bytesOf = (letters) => {
  const values = new Uint8Array(128);
  [...LETTERS].forEach((letter, value) => (values[letter.charCodeAt(0)] = value));
  const words = new DataView(new ArrayBuffer(4 * Math.ceil(letters.length / 5)));
  for (let start = 0; start < letters.length; start += 5) {
    let word = 0;
    for (let place = start; place < start + 5; place++) {
      word = 85 * word + (place < letters.length ? values[letters.charCodeAt(place)] : 84);
    }
    words.setUint32((4 * start) / 5, word);
  }
  return new Uint8Array(words.buffer, 0, Math.floor((4 * letters.length) / 5));
};

// Text, compressed with gzip, in the letters of base85.
const unpacked = (letters) => {
  const bytes = bytesOf(letters);
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
};

new Function(await unpacked(byId("plotly").textContent)).call(window);
const content = JSON.parse(await unpacked(byId("content").textContent));

// A form with values in place of its zeros, in their order.
const filled = (form, values) => {
  if (form === 0) return values.next().value;
  if (Array.isArray(form)) return form.map((part) => filled(part, values));
  return Object.fromEntries(Object.entries(form).map(([key, part]) => [key, filled(part, values)]));
};

// Designs, each of which is read from the columns when it is first asked for.
const designsOf = (fields) => {
  const makers = {};
  const at = (column, row) =>
    Array.isArray(column) ? column[row] : column?.times ? column.times[row] / column.per : column;
  for (const [field, groups] of Object.entries(fields))
    for (const { form, of, columns, places } of groups)
      of.forEach((number, row) => {
        (makers[number] ??= {})[field] = () => {
          const own = places.map((place) => (place < 0 ? -at(columns[-1 - place], row) : at(columns[place], row)));
          return filled(form, own.values());
        };
      });
  const read = (number, made) => {
    const design = Object.fromEntries(Object.entries(made).map(([field, make]) => [field, make()]));
    design.postures.forEach((posture, place) => {
      posture.limits = [];
      const pairs = content.limits[number][place];
      for (let one = 0; one < pairs.length; one += 2)
        posture.limits.push({ ...content.limit_kinds[pairs[one]], price_n_m: pairs[one + 1] });
    });
    return design;
  };
  const designs = {};
  for (const [number, made] of Object.entries(makers)) {
    let known;
    Object.defineProperty(designs, number, { enumerable: true, get: () => (known ??= read(number, made)) });
  }
  return designs;
};
content.designs = designsOf(content.designs);
const { objectives, constraints, parameters, points } = content;

// What joints and links are called, alone and in a sentence.
const called = (name) => content.words[name] ?? name;
const inWords = (text) => text.replaceAll(/\w+/g, called);

const rowOf = new Map(points.number.map((number, row) => [number, row]));
const rows = points.number.map((_, row) => row);
const complete = (row) => objectives.every((objective) => points.objectives[objective.name][row] !== null);
const frontRows = rows.filter((row) => points.kind[row] === "front");
const dominatedRows = rows.filter((row) => points.kind[row] === "feasible" && complete(row));
const infeasibleRows = rows.filter((row) => points.kind[row] === "infeasible");
const hasFront = frontRows.length > 0;

const marksOf = (number) => content.marks.filter((mark) => mark.number === number);
const unscaledMark = content.marks.find((mark) => mark.kind === "unscaled");
const symbolOf = { unscaled: "★", best: "◆", gain: "✚", knee: "■", asked: "▲", near: "●" };

// The constraint on a quantity, if it has one, and whether a value is beyond its bounds.
const constraintOn = (name) => constraints.find((one) => one.name === name);
const isBeyond = ({ lower, upper }, value) =>
  value !== null && ((lower !== null && value < lower) || (upper !== null && value > upper));
const boundsText = ({ lower, upper, unit }) => {
  if (lower === null) return `at most ${withUnit(upper, unit)}`;
  return upper === null ? `at least ${withUnit(lower, unit)}` : `${figure(lower)} to ${withUnit(upper, unit)}`;
};

// An axis of the parallel coordinates: an objective, another constrained quantity or a parameter with its column.
const isObjective = (name) => objectives.some((one) => one.name === name);
const resultAxes = [
  ...objectives.map((one) => ({ ...one, column: points.objectives[one.name], isParameter: false })),
  ...constraints
    .filter((one) => !isObjective(one.name))
    .map(({ name, unit }) => ({
      ...{ name, unit, sense: "" },
      ...{ column: points.constraints[name], isParameter: false },
    })),
];
const axes = [
  ...resultAxes,
  ...parameters.map((one) => ({ ...one, column: points.parameters[one.name], isParameter: true })),
];
const arrowOf = { minimise: "↓", maximise: "↑", "": "" };

// What the slider stops at: loads held still, and the moments of lifts.
const { stops } = content;
const stopText = (stop) => stops[stop].text;
const everyStop = stops.map((_, stop) => stop);
const isLift = (stop) => stops[stop].task.kind === "lift";

// Heights with the same number of decimals.
const decimals = Math.max(
  1,
  ...content.heights_m.map((height) => (String(height).split(".")[1] ?? "").length),
);

// `height` is the stop that is shown, `beside`: the design that is shown next to the selected one.
const state = { selected: null, beside: null, person: 0, payload: 0, height: 0, brushes: new Map(), lasso: null };
const listeners = { selected: [], filter: [], height: [], pair: [], theme: [], view: [] };
const on = (event, listener) => listeners[event].push(listener);
const tell = (event) => listeners[event].forEach((listener) => listener());

const inside = (row) => {
  if (state.lasso && !state.lasso.has(points.number[row])) return false;
  for (const [axis, [low, high]] of state.brushes) {
    const value = axes[axis].column[row];
    if (value === null || value < low || value > high) return false;
  }
  return true;
};

const filtered = () => state.brushes.size > 0 || state.lasso !== null;

const select = (number, { announce = true } = {}) => {
  state.selected = number;
  tell("selected");
  if (announce) byId("announce").textContent = `Design ${number} is shown.`;
};

const brush = (axis, range) => {
  if (range) state.brushes.set(axis, range);
  else state.brushes.delete(axis);
  tell("filter");
};

const lasso = (numbers) => {
  state.lasso = numbers;
  tell("filter");
};

const clearFilter = () => {
  state.brushes.clear();
  state.lasso = null;
  tell("filter");
};
