// Numbers and elements. Whatever comes from the log becomes text here, never markup.

const figure = (value, digits = 4) => {
  if (value === null || value === undefined) return "–";
  if (value === 0) return "0";
  const rounded = Number(value.toPrecision(digits));
  const size = Math.abs(rounded);
  const text = size >= 1e7 || size < 1e-4 ? rounded.toExponential() : String(rounded);
  return text.replace("-", "\u2212");
};

// Four significant digits with their zeros, so that columns line up.
const exact = (value, digits = 4) => {
  if (value === null || value === undefined) return "–";
  const size = Math.abs(value);
  return size >= 1e4 || size < 1e-3
    ? figure(value, digits)
    : value.toPrecision(digits).replace("-", "\u2212");
};

const unitText = (unit) => unit.replaceAll("^2", "²").replaceAll("^3", "³");

const withUnit = (value, unit) =>
  unit === "1" || value === null ? figure(value) : `${figure(value)} ${unitText(unit)}`;

const percent = (share) => `${figure(100 * share, 3)} %`;

const words = (name) => name.replaceAll("_", " ");

const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);

const label = (axis) => `${words(axis.name)} [${unitText(axis.unit)}]`;

// plotly reads a few HTML tags in its texts; a name is no tag
const plain = (text) => String(text).replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");

const element = (tag, properties = {}, ...children) => {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name === "text") made.textContent = value;
    else if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (value === true) made.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
};

const byId = (id) => document.getElementById(id);

const quantile = (values, share) => {
  const sorted = [...values].sort((a, b) => a - b);
  const place = share * (sorted.length - 1);
  const low = Math.floor(place);
  return sorted[low] + (place - low) * ((sorted[low + 1] ?? sorted[low]) - sorted[low]);
};
