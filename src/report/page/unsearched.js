// Stretches of the path where bodies of the vehicle have no pose, so that nothing is known of them.

/** Whether any body has shown pose i. */
function isSearched(i) {
  return !page.bodyPoses || bodyFacts().some((_, body) => hasPose(i, body));
}

const hasPose = (i, body) => page.bodyPoses.there[body * page.poses.count + i] !== 0;

/** ": no answer", or which bodies the value of shown pose i leaves out. */
function unsearchedWords(i) {
  if (!page.bodyPoses) return "";
  const missing = bodyFacts().filter((_, body) => !hasPose(i, body)).map(({ name }) => `"${name}"`);
  if (missing.length === 0) return "";
  if (!isSearched(i)) return "no answer, as the vehicle has no pose here";
  return `without ${missing.length === 1 ? "body" : "the bodies"} ${joined(missing)}, no pose here`;
}

/** "0.00 to 10.00 m and 90.00 to 100.00 m"; of many stretches the first few. */
function stretchWords(stretches) {
  const most = 6, words = stretches.slice(0, most).map(({ chainage_from: from, chainage_to: to }) =>
      `${station(from).replace(` ${unitSymbol}`, "")} to ${station(to)}`);
  const more = stretches.length - most;
  return joined(more > 0 ? [...words, `${plural(more, "more stretch", "more stretches")}`] : words);
}

const silentStretches = () => page.facts.unsearched.filter((s) => !s.has_answer);

/** The stretches that other bodies were searched on: a list for each set of missing bodies. */
function partStretches() {
  const lists = new Map();
  for (const stretch of page.facts.unsearched.filter((s) => s.has_answer)) {
    const names = joined(stretch.bodies.map((name) => `"${name}"`));
    const which = (stretch.bodies.length === 1 ? "body " : "bodies ") + names;
    lists.set(which, [...lists.get(which) ?? [], stretch]);
  }
  return [...lists];
}

/** Over which part of the path the verdict was found; empty where that is all of it. */
function searchedSentence() {
  const silent = silentStretches();
  return page.facts.words.searched + (silent.length > 0 ? ` At chainage ${stretchWords(silent)} the vehicle has no pose, ` +
                                                          "so nothing is known there." : "");
}

/** The patterns of the shaded stretches, for the profile and its legend. */
function unsearchedPatterns() {
  const pattern = (id, size, ...marks) => make("pattern", { id, width: size, height: size,
      patternUnits: "userSpaceOnUse" }, make("rect", { width: size, height: size, fill: "#e5e7eb" }), ...marks);
  const line = (x1, y1, x2, y2) => make("line", { x1, y1, x2, y2, stroke: "#6b7280", "stroke-width": 1 });
  return [pattern("no-answer", 8, line(0, 0, 8, 8), line(0, 8, 8, 0)),
          pattern("part-answer", 8, make("circle", { cx: 4, cy: 4, r: 1.3, fill: "#6b7280" }))];
}

/** Shaded stretches of the profile on which bodies have no pose. */
const profileUnsearched = () => profile.shaded(page.facts.unsearched.map(({ chainage_from: from, chainage_to: to, has_answer: part }) =>
    ({ from, to, kind: part ? "part-answer" : "no-answer", words: part ? "a part only" : "no answer" })));

/** What the shading means and where it is, in words below the profile. */
function unsearchedLegend() {
  const rows = partStretches().map(([which, stretches]) => make("li", {}, swatch("part-answer", "#6b7280"),
      ` A part only: without ${which}, which ${stretches[0].bodies.length === 1 ? "has" : "have"} no pose at ` +
      `chainage ${stretchWords(stretches)}.`));
  const silent = silentStretches();
  if (silent.length > 0) {
    rows.unshift(make("li", {}, swatch("no-answer", "#6b7280"),
        ` No answer: the vehicle has no pose at chainage ${stretchWords(silent)}.`));
  }
  return rows;
}

/** Dashes on the plan's path where nothing was searched. */
function drawUnsearchedPath(context, painter, unitSize) {
  const n = page.poses.count;
  context.save();
  context.setLineDash([5 * unitSize, 5 * unitSize]);
  for (let first = 0; first < n; ++first) {
    if (isSearched(first)) continue;
    let last = first;
    while (last + 1 < n && !isSearched(last + 1)) ++last;
    strokeThrough(context, projectedPath(painter, Math.max(0, first - 1), Math.min(n - 1, last + 1)), "#fff", 2.6 * unitSize);
    first = last;
  }
  context.restore();
}

const unsearchedNote = () => silentStretches().length > 0
    ? " Where the path is dashed, the vehicle has no pose and nothing is known." : "";
