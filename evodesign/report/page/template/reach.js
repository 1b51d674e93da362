// The interval of load heights that the robot can hold, with the required ones.
const reachFigure = (row) => {
  const [low, high] = [points.lowest_m[row], points.highest_m[row]];
  const from = points.or_lower[row] ? `${figure(low)} m or lower` : figure(low);
  const box = element("div", { class: "reach" });
  if (low === null || high === null) {
    box.append(element("p", { class: "plain", text: "Reach interval not known." }));
    return box;
  }
  const known = points.highest_m.filter((value) => value !== null);
  const most =
    Math.max(
      known.reduce((a, b) => Math.max(a, b), 0),
      ...content.heights_m,
      1,
    ) * 1.02;
  const x = (height) => `${(100 * height) / most}%`;
  const within = (height) => height >= low && height <= high;
  const ticks = content.heights_m
    .map(
      (height) =>
        `<g${within(height) ? "" : ' class="out"'}><line x1="${x(height)}" x2="${x(height)}" y1="16" y2="30" stroke="var(--${within(height) ? "ink" : "second"})" stroke-width="1.5"/><text x="${x(height)}" y="44" text-anchor="middle"${within(height) ? "" : ' class="out"'}>${height.toFixed(decimals)}</text></g>`,
    )
    .join("");
  box.innerHTML = `<svg role="img" aria-label="Holds loads from ${from} to ${figure(high)} m">
    <line x1="0" x2="100%" y1="23" y2="23" stroke="var(--line)" stroke-width="8" stroke-linecap="round"/>
    <line x1="${x(low)}" x2="${x(high)}" y1="23" y2="23" stroke="var(--accent)" stroke-width="8"/>${ticks}
    <text x="0" y="10">Holds loads from ${from} to ${figure(high)} m; required [m]:</text></svg>`;
  return box;
};
