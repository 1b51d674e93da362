// Light and dark: as the system says, until the reader says otherwise.

const system = window.matchMedia("(prefers-color-scheme: dark)");
const narrow = window.matchMedia("(max-width: 640px)");
const root = document.documentElement;
const colour = (name) => getComputedStyle(root).getPropertyValue(`--${name}`).trim();

const applyTheme = (theme) => {
  root.dataset.theme = theme;
  byId("theme").textContent = theme === "dark" ? "Light page" : "Dark page";
  tell("theme");
};

let followsSystem = true;
root.dataset.theme = system.matches ? "dark" : "light";
system.addEventListener("change", () => followsSystem && applyTheme(system.matches ? "dark" : "light"));
byId("theme").addEventListener("click", () => {
  followsSystem = false;
  applyTheme(root.dataset.theme === "dark" ? "light" : "dark");
});

// Everything that plotly's figures share.
const plotFont = () => ({
  family: getComputedStyle(document.body).fontFamily,
  size: 12,
  color: colour("soft"),
});

const plotLayout = (more = {}) => ({
  paper_bgcolor: "rgba(0,0,0,0)",
  plot_bgcolor: "rgba(0,0,0,0)",
  font: plotFont(),
  margin: { l: 56, r: 12, t: 12, b: 44 },
  showlegend: false,
  modebar: { bgcolor: "rgba(0,0,0,0)", color: colour("faint"), activecolor: colour("accent") },
  hoverlabel: {
    bgcolor: colour("surface"),
    bordercolor: colour("line"),
    align: "left",
    font: { ...plotFont(), color: colour("ink") },
  },
  ...more,
});

const plotAxis = (title, more = {}) => ({
  title: { text: plain(title), standoff: 8 },
  gridcolor: colour("line"),
  linecolor: colour("faint"),
  zerolinecolor: colour("line"),
  ticks: "outside",
  ticklen: 4,
  tickcolor: colour("faint"),
  ...more,
});

const plotConfig = { displaylogo: false, responsive: true, displayModeBar: false };
const zoomButtons = {
  displayModeBar: true,
  modeBarButtons: [["zoom2d", "select2d", "lasso2d", "resetScale2d"]],
};

// One hue from a wash to its full strength, which stands for the better values.
const strength = () => [
  [0, colour("weak")],
  [1, colour("strong")],
];

const hasWebgl = Boolean(document.createElement("canvas").getContext("webgl2"));

// Colours of the palette as three numbers from 0 to 1.
const rgb = (name) => {
  const hex = colour(name).slice(1);
  return [0, 2, 4].map((start) => parseInt(hex.slice(start, start + 2), 16) / 255);
};

const mixed = (a, b, share) => a.map((value, index) => value + share * (b[index] - value));

const mixedColour = (first, second, share) =>
  `rgb(${mixed(rgb(first), rgb(second), share)
    .map((part) => Math.round(255 * part))
    .join(",")})`;
