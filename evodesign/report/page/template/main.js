// Everything in its place; then the first design: the sharpest knee, else the first marked one.

startHead();
startFront();
startChips();
startParallel();
startProgress();
startFailures();
startImportance();
startFamilies();
startPeople();
startTable();
startCard();
startBeside();
applyTheme(root.dataset.theme);

const firstShown =
  content.marks.find((mark) => mark.kind === "asked") ??
  content.marks.find((mark) => mark.kind === "knee") ??
  content.marks.find((mark) => mark.kind !== "unscaled") ??
  content.marks[0];
if (firstShown) select(firstShown.number, { announce: false });
else if (points.number.length) select(points.number[0], { announce: false });
startLink();

// For whoever wants to script the page, and for its tests.
window.evodesign = {
  ...{ content, state, select, brush, clearFilter, linkPoses, treeOf, showCase, shownCase, postureAt },
  ...{ sceneItems, verticesOf, camera, look, linkText },
};
