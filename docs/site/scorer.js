// What the search of the site counts. A word beats a part of one: 'stall' is not 'Install'. Pages that
// people have written come before those that tables make, and before the list of changes.
var Scorer = {
  score: ([docname, , , , score]) => (/^(reference\/|CHANGELOG)/.test(docname) ? score / 2 : score),
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 3,
  term: 5,
  partialTerm: 1,
};
