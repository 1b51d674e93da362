// Parallel coordinates, turned: each axis is a row that reads from left to right, each design a line
// downwards. An axis has a brush of two handles, which are sliders for the keyboard and for screen readers.

const STEPS = 1000;
const ROW = 27;
const NARROW_ROW = 47;
const GAP = 12;

let showsAll = !hasFront || frontRows.length < 5;

const lineRows = () => {
  if (!hasFront) return dominatedRows.length ? dominatedRows : infeasibleRows;
  return showsAll ? [...dominatedRows, ...frontRows] : frontRows;
};

const extent = (axis) => {
  if (axis.isParameter) return [axis.lower, axis.upper];
  const marked = content.marks.map((mark) => rowOf.get(mark.number));
  const values = [...lineRows(), ...marked]
    .map((row) => axis.column[row])
    .filter((value) => value !== null);
  const low = values.reduce((a, b) => Math.min(a, b), Infinity);
  const high = values.reduce((a, b) => Math.max(a, b), -Infinity);
  if (values.length === 0) return [NaN, NaN];
  return low === high ? [low - 0.5, high + 0.5] : [low, high];
};

let extents = axes.map(extent);

// Where the middle of an axis stands; on a narrow page its name and range are above it.
const rowHeight = () => (narrow.matches ? NARROW_ROW : ROW);
const topOf = (index) =>
  index * rowHeight() +
  (index >= resultAxes.length ? GAP : 0) +
  (narrow.matches ? NARROW_ROW - ROW / 2 : ROW / 2);

const shareOf = (index, value) => (value - extents[index][0]) / (extents[index][1] - extents[index][0]);
const valueAt = (index, share) => extents[index][0] + share * (extents[index][1] - extents[index][0]);

const drawLines = () => {
  const canvas = byId("lines");
  const ratio = window.devicePixelRatio || 1;
  canvas.style.height = `${topOf(axes.length - 1) + ROW / 2}px`;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  canvas.width = width * ratio;
  canvas.height = height * ratio;
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio);
  const trace = (row) => {
    pen.beginPath();
    axes.forEach((axis, index) => {
      const value = axis.column[row];
      const share = Math.min(1, Math.max(0, shareOf(index, value)));
      if (value !== null) pen.lineTo(share * width, topOf(index));
    });
    pen.stroke();
  };
  const draw = (wanted, ink, opacity, thickness) => {
    pen.strokeStyle = colour(ink);
    pen.globalAlpha = opacity;
    pen.lineWidth = thickness;
    wanted.forEach(trace);
  };
  const shown = lineRows();
  const onFront = (row) => points.kind[row] === "front";
  const kept = shown.filter(inside);
  const dense = Math.min(1, Math.max(0.05, 30 / Math.max(kept.length, 1)));
  if (filtered())
    draw(
      shown.filter((row) => !inside(row) && onFront(row)),
      "faint",
      0.16,
      1,
    );
  draw(
    kept.filter((row) => !onFront(row)),
    hasFront ? "faint" : "accent",
    Math.max(0.08, dense * 0.5),
    1,
  );
  draw(kept.filter(onFront), "accent", dense, 1.2);
  if (unscaledMark) draw([rowOf.get(unscaledMark.number)], "ink", 0.55, 1.4);
  if (rowOf.has(state.selected)) draw([rowOf.get(state.selected)], "second", 1, 2.6);
};

let waiting = false;
const drawLinesSoon = () => {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => {
    waiting = false;
    drawLines();
  });
};

const axisName = (axis) => {
  if (!axis.isParameter) {
    const constraint = constraintOn(axis.name);
    const aims = [axis.sense && `to ${axis.sense}`, constraint && boundsText(constraint)].filter(Boolean);
    return element(
      "span",
      { class: "name", title: `${axis.name} [${axis.unit}], ${aims.join(", ")}` },
      element("b", { text: `${capital(words(axis.name))} ` }),
      element("small", { text: arrowOf[axis.sense] || boundsText(constraint) }),
    );
  }
  const [kind, ...group] = axis.name.split(".");
  const text = group.length ? `${capital(words(group.join(".")))} ` : capital(words(kind));
  return element(
    "span",
    { class: "name", title: `${axis.name} [${axis.unit}]` },
    text,
    element("small", { text: group.length ? words(kind) : "" }),
  );
};

const axisRow = (axis, index) => {
  const handle = (end) =>
    element("input", {
      type: "range",
      min: 0,
      max: STEPS,
      step: 1,
      "data-end": end,
      "aria-label": `${end === 0 ? "Least" : "Greatest"} ${words(axis.name)}`,
    });
  const handles = [handle(0), handle(1)];
  const span = element("span", { class: "span" });
  const track = element("div", { class: "track" }, span, ...handles);
  const range = element("span", { class: "range" });
  const row = element(
    "div",
    { class: `axis${index === resultAxes.length ? " gap" : ""}`, "data-axis": axis.name },
    axisName(axis),
    track,
    range,
  );

  const show = () => {
    const brushed = state.brushes.get(index);
    const shares = brushed ? brushed.map((value) => Math.min(1, Math.max(0, shareOf(index, value)))) : [0, 1];
    row.classList.toggle("active", Boolean(brushed));
    handles.forEach((one, end) => {
      one.value = Math.round(shares[end] * STEPS);
      one.setAttribute("aria-valuetext", withUnit(brushed ? brushed[end] : extents[index][end], axis.unit));
    });
    span.style.left = `${100 * shares[0]}%`;
    span.style.width = `${100 * (shares[1] - shares[0])}%`;
    const [low, high] = brushed ?? extents[index];
    range.textContent = Number.isNaN(low)
      ? "no value"
      : `${figure(low)} to ${withUnit(high, axis.unit)}${axis.unit === "1" && axis.isParameter ? " ×" : ""}`;
  };
  const set = (low, high) => {
    const whole = low <= 0 && high >= 1;
    brush(
      index,
      whole
        ? null
        : [
            low <= 0 ? extents[index][0] : valueAt(index, low),
            high >= 1 ? extents[index][1] : valueAt(index, high),
          ],
    );
  };
  handles.forEach((one, end) =>
    one.addEventListener("input", () => {
      const shares = handles.map((other) => Number(other.value) / STEPS);
      if (shares[0] > shares[1]) shares[1 - end] = shares[end];
      set(shares[0], shares[1]);
    }),
  );
  dragBrush(track, set);
  on("filter", show);
  show();
  return { row, show };
};

// Drag across the free part of a track to brush it; a plain click takes the brush away.
const dragBrush = (track, set) => {
  const shareAt = (event) => {
    const box = track.getBoundingClientRect();
    return Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
  };
  track.addEventListener("pointerdown", (event) => {
    if (event.target.tagName === "INPUT") return;
    const start = shareAt(event);
    track.setPointerCapture(event.pointerId);
    const move = (moved) => {
      const end = shareAt(moved);
      if (Math.abs(end - start) > 0.01) set(Math.min(start, end), Math.max(start, end));
    };
    const stop = (ended) => {
      track.removeEventListener("pointermove", move);
      if (Math.abs(shareAt(ended) - start) <= 0.01) set(0, 1);
    };
    track.addEventListener("pointermove", move);
    track.addEventListener("pointerup", stop, { once: true });
  });
};

const sayBrushed = () => {
  byId("clear").disabled = !filtered();
  const shown = lineRows();
  const kept = shown.filter(inside).length;
  const noun = `design${shown.length === 1 ? "" : "s"}${hasFront && !showsAll ? " of the front" : ""}`;
  const row = rowOf.get(state.selected);
  const beyond = axes.filter(({ column }, index) => {
    const [low, high] = extents[index];
    return row !== undefined && column[row] !== null && (column[row] < low || column[row] > high);
  });
  const outside = beyond.map((axis) => words(axis.name)).join(", ");
  byId("brushed").textContent =
    (filtered() ? `${kept} of ${shown.length} ${noun} are inside the brushes.` : `${shown.length} ${noun}.`) +
    (outside ? ` Design ${state.selected} lies beyond the end of: ${outside}.` : "");
};

const startParallel = () => {
  const place = byId("parallel");
  byId("all-label").hidden = !hasFront || dominatedRows.length === 0;
  byId("all").checked = showsAll;
  if (lineRows().length === 0) {
    place.append(element("p", { class: "plain", text: "No evaluation yet." }));
    for (const idle of ["clear", "brushed", "parallel-hint"]) byId(idle).hidden = true;
    return;
  }
  const canvas = element("canvas", { id: "lines", "aria-hidden": "true" });
  const made = axes.map(axisRow);
  place.append(canvas, ...made.map(({ row }) => row));
  const key = (ink, text) =>
    element(
      "span",
      {},
      element("i", { style: `background:var(--${ink});height:3px;width:18px;vertical-align:middle` }),
      text,
    );
  place.append(
    element(
      "p",
      { class: "legend" },
      key("accent", hasFront ? "front" : "designs"),
      key("second", "chosen design"),
      ...(unscaledMark ? [key("ink", "unscaled robot")] : []),
    ),
  );
  byId("all").addEventListener("change", (event) => {
    showsAll = event.target.checked;
    extents = axes.map(extent);
    made.forEach(({ show }) => show());
    sayBrushed();
    drawLinesSoon();
  });
  byId("clear").addEventListener("click", clearFilter);
  for (const event of ["filter", "selected"]) on(event, sayBrushed);
  for (const event of ["filter", "selected", "theme"]) on(event, drawLinesSoon);
  new ResizeObserver(drawLinesSoon).observe(place);
  sayBrushed();
};
