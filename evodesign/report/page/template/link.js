// A link to what is seen, in the address's fragment: the chosen designs, the case, where the camera stands, the
// axes of the front and the brushes.

const stopNames = stops.map(({ task, height_m: height, text }) => (task.kind === "lift" ? text : String(height)));

const linkText = () => {
  const told = new URLSearchParams();
  if (state.selected !== null) told.set("design", state.selected);
  if (state.beside !== null) told.set("beside", state.beside);
  if (content.people.length > 1) told.set("person", content.people[state.person]);
  if (content.payloads.length > 1) told.set("load", content.payloads[state.payload]);
  if (stops.length > 1) told.set("height", stopNames[state.height]);
  const { turn, tilt, distance } = camera;
  told.set("camera", [turn, tilt, distance].map((value) => value.toFixed(3)).join(" "));
  for (const key of ["across", "up", "colour"]) told.set(key, frontAxes[drawnIn[key]]?.name ?? "none");
  if (drawnIn.solid) told.set("view", "3D");
  for (const [axis, [low, high]] of state.brushes) told.append("keep", `${low} ${high} ${axes[axis].name}`);
  return told.toString();
};

// Show what a link says; what it says of things that this page does not have is left out.
const follow = (text) => {
  const told = new URLSearchParams(text);
  const place = (names, key, otherwise) => {
    const found = names.findIndex((name) => String(name) === told.get(key));
    return found < 0 ? otherwise : found;
  };
  const number = (key) => (told.has(key) && rowOf.has(Number(told.get(key))) ? Number(told.get(key)) : null);
  state.person = place(content.people, "person", state.person);
  state.payload = place(content.payloads, "load", state.payload);
  state.height = place(stopNames, "height", state.height);
  const names = frontAxes.map((axis) => axis.name);
  for (const key of ["across", "up"]) drawnIn[key] = place(names, key, drawnIn[key]);
  if (told.has("colour")) drawnIn.colour = place(names, "colour", NO_COLOUR);
  const solid = told.get("view") === "3D" && hasWebgl;
  if (hasFront) showAxes(solid);
  state.brushes.clear();
  for (const text of told.getAll("keep")) {
    const [low, high, ...name] = text.split(" ");
    const axis = axes.findIndex((one) => one.name === name.join(" "));
    if (axis >= 0 && Number(low) <= Number(high)) state.brushes.set(axis, [Number(low), Number(high)]);
  }
  tell("filter");
  state.beside = number("beside");
  const design = number("design");
  if (design !== null) select(design, { announce: false });
  else tell("selected");
  const seen = (told.get("camera") ?? "").split(" ").map(Number);
  if (seen.length === 3 && seen.every(Number.isFinite)) look(...seen);
};

let lastLink = null;
let linkAwaited = false;

const keepLink = () => {
  if (linkAwaited) return;
  linkAwaited = true;
  setTimeout(() => {
    linkAwaited = false;
    lastLink = linkText();
    history.replaceState(null, "", `#${lastLink}`);
  }, 200);
};

const startLink = () => {
  if (location.hash.length > 1) follow(location.hash.slice(1));
  for (const event of ["selected", "filter", "height", "pair", "view"]) on(event, keepLink);
  window.addEventListener("hashchange", () => {
    if (location.hash.slice(1) !== lastLink) follow(location.hash.slice(1));
  });
};
