// The 3D view of the chosen design with its height slider.

let viewer = null;
let stageBox = null;
let shownScene = null;
const stillness = window.matchMedia("(prefers-reduced-motion: reduce)");

const stageOf = () => {
  const canvasOf = (id) =>
    element("canvas", {
      ...{ id, tabindex: 0, role: "application", "aria-roledescription": "3D view", "aria-label": "Posture" },
    });
  const views = element(
    "div",
    { class: "views" },
    ...Object.entries(VIEWS).map(([name, [turn, tilt]]) =>
      element("button", {
        type: "button",
        class: "quiet",
        text: name,
        onclick: () => look(turn, tilt),
      }),
    ),
  );
  const missing = element("p", { class: "missing", hidden: true });
  const key = (ink, text) => element("span", {}, element("i", { style: `background:${ink}` }), text);
  const legend = element(
    "p",
    { class: "legend" },
    key("var(--accent)", "robot: links that designs change"),
    key("color-mix(in srgb, var(--accent) 48%, var(--surface))", "other links"),
    ...(hasPeople()
      ? [key("color-mix(in srgb, var(--second) 65%, var(--faint))", "person")]
      : []),
    key("var(--third)", `force of the ground, 1 m for ${NEWTONS_PER_METRE} N`),
  );
  const canvases = ["posture-beside", "posture"].map((id) => element("figure", {}, canvasOf(id), element("figcaption")));
  return element("div", { class: "stage" }, ...canvases, views, missing, legend);
};

// The stage is made once: its canvas holds what the graphics card was given. The one of a comparison is made with
// the first.
let viewerBeside = null;
const viewerOf = (id) => {
  const made = new Viewer(stageBox.querySelector(`#${id}`));
  steer(made.canvas);
  return made;
};
const theStage = () => {
  stageBox ??= stageOf();
  viewer ??= viewerOf("posture");
  if (comparing()) viewerBeside ??= viewerOf("posture-beside");
  stageBox.classList.toggle("two", comparing());
  return stageBox;
};

const showBeside = (at) => {
  const [first, second] = stageBox.querySelectorAll("figcaption");
  [first.textContent, second.textContent] = comparing() ? [`Design ${state.beside}`, `Design ${state.selected}`] : ["", ""];
  if (!comparing()) return;
  const design = content.designs[state.beside] ?? NOTHING_KNOWN;
  const posture = postureAt(design, at);
  const label = posture ? `Design ${state.beside}, ${caseText(at)}` : `Design ${state.beside}: no posture of this case`;
  viewerBeside.canvas.setAttribute("aria-label", label);
  if (!posture) first.textContent = label;
  viewerBeside.show(sceneItems(design, posture?.agents ?? {}, at, loadHeight(posture, at)));
};

const withoutStage = () =>
  element("p", {
    class: "plain stageless",
    text: "This browser offers no WebGL, so postures are not drawn; their figures are below.",
  });

const heightControl = (design) => {
  const last = stops.length - 1;
  const slider = element("input", {
    type: "range",
    id: "height",
    min: 0,
    max: last,
    step: 1,
    value: state.height,
    disabled: last === 0,
  });
  const play = element("button", {
    ...{ type: "button", class: "quiet", id: "play", text: "Play", title: "Show the lift as long as it takes" },
    onclick: () => playLift(design),
  });
  const pair = pairControl();
  const output = element("output", { for: "height" });
  const detail = element("p", { id: "height-detail" });
  const near = element("p", { id: "nearest-bodies" });
  const show = () => {
    const at = shownCase();
    const outcome = outcomeAt(design, at);
    const height = loadHeight(postureAt(design, at), at);
    output.textContent = isLift(at.stop) ? `${stopText(at.stop)}, ${exact(height, 3)} m` : stopText(at.stop);
    pair.show();
    play.hidden = !hasWebgl || !isLift(at.stop);
    const solved = outcome?.status === "solved";
    detail.textContent = outcome
      ? solved
        ? `Solved: ${isLift(at.stop) ? "at most " : ""}robot |torque| ${exact(outcome.robot_torque_norm)} N m${outcome.human_torque_norm == null ? "" : `, person ${exact(outcome.human_torque_norm)} N m`}; largest residual ${figure(outcome.residual, 2)}`
        : `${capital(outcome.status)}: ${outcome.reason}`
      : `The log holds no outcome for this ${severalPairs ? "case" : "height"}.`;
    const gap = clearanceAt(design, at);
    near.textContent = gap ? `${clearanceText(gap)}.` : "";
    slider.value = state.height;
    slider.setAttribute("aria-valuetext", `${stopText(at.stop)}, ${outcome?.status ?? "unknown"}`);
  };
  slider.addEventListener("input", () => {
    state.height = Number(slider.value);
    tell("height");
  });
  const box = element(
    "div",
    { class: "height" },
    ...[pair.box].filter(Boolean),
    element("label", { for: "height", text: stops.some(({ task }) => task.kind === "lift") ? "Load and moment" : "Height of the load" }),
    slider,
    output,
    play,
    detail,
    near,
  );
  return { box, show };
};

// The lift that is shown from its beginning to its end in real time, straight between the moments of the page.
const playLift = (design) => {
  const at = shownCase();
  const own = everyStop.filter((stop) => taskTexts[stop] === taskTexts[at.stop]);
  const postures = own.map((stop) => postureAt(design, { ...at, stop }));
  if (!postures.every(Boolean)) return;
  const times = own.map((stop) => stops[stop].time_s);
  const begun = performance.now();
  const playing = (shownScene = { number: state.selected, agents: postures.at(-1).agents });
  const frame = (now) => {
    if (shownScene !== playing) return;
    const time = Math.max(0, (now - begun) / 1000);
    const next = times.findIndex((end) => end > time);
    if (next < 0) {
      shownScene = null;
      state.height = own.at(-1);
      tell("height");
      return;
    }
    const [from, to] = [postures[next - 1], postures[next]];
    const share = (time - times[next - 1]) / (times[next] - times[next - 1]);
    const agents = Object.entries(to.agents).map(([name, end]) => [name, between(from.agents[name], end, share)]);
    const height = loadHeight(from, at) + share * (loadHeight(to, at) - loadHeight(from, at));
    viewer.show(sceneItems(design, Object.fromEntries(agents), at, height));
    requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
};

const showPosture = (number, design, moving) => {
  const at = shownCase();
  const posture = postureAt(design, at);
  showBeside(at);
  const missing = stageBox.querySelector(".missing");
  missing.hidden = Boolean(posture);
  missing.textContent = posture ? "" : `No posture ${severalPairs ? "of" : "at"} ${caseText(at)}.`;
  stageBox
    .querySelector("#posture")
    .setAttribute(
      "aria-label",
      posture
        ? `Design ${number}${hasPeople() ? " and the person" : ""} holding the load${severalPairs ? ":" : " at"} ${caseText(at)}. Arrow keys turn the view.`
        : missing.textContent,
    );
  const from = shownScene?.number === number ? shownScene : null;
  if (!posture) {
    shownScene = null;
    viewer.show(sceneItems(design, {}, at));
    return;
  }
  const target = { number, height: loadHeight(posture, at), agents: posture.agents };
  if (!moving || !from || stillness.matches) {
    shownScene = target;
    viewer.show(sceneItems(design, target.agents, at, target.height));
    return;
  }
  const begun = performance.now();
  shownScene = target;
  const frame = (now) => {
    if (shownScene !== target) return;
    const linear = Math.min(1, Math.max(0, (now - begun) / 280));
    const share = linear * linear * (3 - 2 * linear);
    const agents =
      share === 1
        ? target.agents
        : Object.fromEntries(
            Object.entries(target.agents).map(([name, to]) => [name, between(from.agents[name], to, share)]),
          );
    viewer.show(sceneItems(design, agents, at, from.height + share * (target.height - from.height)));
    if (linear < 1) requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
};
