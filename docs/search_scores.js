// How Sphinx's search ranks pages: as usual, but recipes count twice, and a page that is called so comes first.
const asked = new URLSearchParams(location.search).get("q") ?? "";
var Scorer = {
  score: ([page, , , , score]) =>
    score * (page.includes("/recipes/") ? 2 : 1) + (page.endsWith(`/${asked.trim().toLowerCase()}`) ? 50 : 0),
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
