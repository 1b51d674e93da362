// Which design of the front the pointer means: of the symbols that it is on, the nearest of those that are drawn
// on top. Plotly means the smallest symbol near by, which may lie hidden behind a mark.

const LAYERS = [MARK_TRACES, ["front"]];

// The symbols of a layer that a place on the screen is on, nearest first, as plotly tells points.
const symbolsAt = (names, { clientX, clientY }) => {
  const plot = byId("front");
  const { xaxis, yaxis } = plot._fullLayout;
  const { left, top } = plot.getBoundingClientRect();
  const [x, y] = [clientX - left - xaxis._offset, clientY - top - yaxis._offset];
  return plot.data
    .flatMap((trace, curveNumber) =>
      names.includes(trace.name)
        ? trace.customdata.map((customdata, pointNumber) => ({
            ...{ customdata, curveNumber, pointNumber, size: trace.marker.size },
            away: Math.hypot(xaxis.d2p(trace.x[pointNumber]) - x, yaxis.d2p(trace.y[pointNumber]) - y),
          }))
        : [],
    )
    .filter(({ away, size }) => away <= size / 2)
    .sort((one, other) => one.away - other.away);
};

const pointed = ({ points: [found], event }) => {
  if (drawnIn.solid || !event) return found;
  for (const names of LAYERS) {
    const [nearest] = symbolsAt(names, event);
    if (nearest) return nearest;
  }
  return found;
};

// Plotly's label is of the design that a click would choose.
const labelPointed = (event) => {
  const meant = pointed(event);
  if (manyPoints || meant.customdata === event.points[0].customdata) return;
  Plotly.Fx.hover(byId("front"), [{ curveNumber: meant.curveNumber, pointNumber: meant.pointNumber }]);
};
