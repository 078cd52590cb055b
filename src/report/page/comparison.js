// The page of two results whose conflicts are compared: the answer, the question, the path from above, and each obstacle in a row.

const isSame = ({ what }) => what === "same";

/** Places that share a conflict of either result are one obstacle, with the worst of their fates. */
function joinedPlaces() {
  const groupOf = new Map(), groups = new Set();
  const keysOf = ({ a, b }) => a && b ? [`a${a.id}`, `b${b.id}`] : [];
  for (const place of page.facts.places) {
    const met = [...new Set(keysOf(place).map((key) => groupOf.get(key)).filter(Boolean))];
    const group = [...met.flat(), place];
    met.forEach((one) => groups.delete(one));
    groups.add(group);
    group.flatMap(keysOf).forEach((key) => groupOf.set(key, group));
  }
  return [...groups];
}

/** What one of the results has of an obstacle, each conflict once. */
const conflictsIn = (places, side) =>
    [...new Map(places.map((place) => place[side]).filter(Boolean).map((one) => [one.id, one])).values()].sort((x, y) => x.id - y.id);

function obstacleOf(places) {
  const worst = places.reduce((x, y) => y.rank < x.rank ? y : x), [a, b] = ["a", "b"].map((side) => conflictsIn(places, side));
  const { middle, side } = places.find((place) => b.length > 0 ? place.b?.id === b[0].id : place.a?.id === a[0].id);
  const ends = places.flatMap(({ chainage }) => chainage), notes = places.map(({ note }) => note).filter(Boolean);
  return { ...worst, a, b, middle, side, from: Math.min(...ends), to: Math.max(...ends), note: notes.join("; ") };
}

/** All obstacles, worst first, and then along the path. */
const obstacles = joinedPlaces().map(obstacleOf).sort((x, y) => x.rank - y.rank || x.from - y.from)
    .map((obstacle, i) => ({ ...obstacle, number: i + 1 }));

function buildComparison() {
  const { word, kind, sentence } = page.facts;
  const tile = (words, ...whats) => make("div", { class: "tile" },
      make("strong", {}, count(obstacles.filter(({ what }) => whats.includes(what)).length)), make("span", {}, words));
  byId("verdict-body").append(answerBanner({ kind, word, lines: [make("p", { id: "answer" }, asSentence(sentence))] }),
      make("div", { class: "tiles" }, tile("new", "new", "new part", "new small group"), tile("worse", "worse"),
           tile("not known", "not searched", "not known whether worse"),
           tile("gone or too small to be listed", "gone", "too small"), tile("the same", "same")));
}

function buildQuestion() {
  const { radius, worse_by: worse, sides, questions } = page.facts;
  byId("question-body").append(factsTable(
      ["Asked", `Is anything closer than ${shortLength(radius)} to the vehicle in b that was not there in a, or closer than in a?`],
      ...sides.map(({ name, words, report }) => [name, words, report && "; ", report && make("a", { href: report }, "its report")]),
      ...questions.map(({ what, a, b }) => ["Differs", `${what}: ${a} in a, ${b} in b`])),
    make("p", { class: "note" }, "Conflicts are the same where their points are near each other, and worse where they come nearer, " +
        `or reach deeper, by more than ${shortLength(worse)}.`));
}

/** The path from above, north up, with a mark for each obstacle, the worst on top. */
function buildPathPlan() {
  const { path } = page.facts, places = [...path, ...obstacles.map(({ middle }) => middle)], wide = 1200, edge = 40;
  const [x, y] = [0, 1].map((k) => places.reduce(([low, high], p) => [Math.min(low, p[k]), Math.max(high, p[k])], [Infinity, -Infinity]));
  const scale = Math.min((wide - 2 * edge) / Math.max(x[1] - x[0], 1), (560 - 2 * edge) / Math.max(y[1] - y[0], 1));
  const tall = Math.max(scale * Math.max(y[1] - y[0], 1) + 2 * edge, 120);
  const at = (p) => [wide / 2 + (p[0] - (x[0] + x[1]) / 2) * scale, tall / 2 - (p[1] - (y[0] + y[1]) / 2) * scale];
  const marks = obstacles.map((obstacle) => {
    const [cx, cy] = at(obstacle.middle), same = isSame(obstacle);
    return make("g", { class: "mark", ...chosenBy(() => { location.hash = `row${obstacle.number}`; }) },
        make("title", {}, obstacle.what),
        make("circle", { cx, cy, r: same ? 4 : 7, class: `status ${obstacle.kind}`, fill: "#fff", stroke: "currentColor",
                         "stroke-width": 2 }),
        !same && make("text", { x: cx + 9, y: cy - 7, class: "strong halo" }, String(obstacle.number)));
  });
  const bar = roundLength(wide / 4 / scale);
  byId("plan-body").append(scrollBox("tall", make("svg",
      { viewBox: `0 0 ${wide} ${tall}`, role: "img", style: "min-width: 46rem", "aria-label": "The path from above, and the conflicts" },
      make("path", { class: "curve", d: `M${path.map((p) => at(p).map((v) => v.toFixed(1))).join("L")}` }), marks.reverse(),
      make("path", { class: "surface", d: `M16 ${tall - 14}h${bar * scale}` }),
      make("text", { x: 24 + bar * scale, y: tall - 10, class: "strong" }, shortLength(bar)))));
}

/** Of both results, such as "0.080 → 0.030", or the one that is known. */
function change({ a, b }, words) {
  const [before, now] = [words(a), words(b)];
  return before && now && before !== now ? `${before} → ${now}` : now || before;
}

const leastOf = (list) => {
  const known = list.map(({ distance }) => distance).filter((v) => v !== null);
  return known.length > 0 ? Math.min(...known).toFixed(3) : "";
};
const pointsOf = (list) => list.length > 0 ? count(list.reduce((sum, { points }) => sum + points, 0)) : "";
const idsOf = (list) => list.map(({ id }) => id ?? "").join(", ") || "–";

/** Each obstacle in a row. What is the same in both is folded where it is much. */
function buildObstacles() {
  if (obstacles.length === 0) return removePart("obstacles");
  const columns = columnsOf([
    ["", ({ number }) => String(number), "number"],
    ["What", ({ what, kind }) => make("span", { class: `status ${kind}` }, what)],
    ["No. in a", ({ a }) => idsOf(a), "number"],
    ["No. in b", ({ b }) => idsOf(b), "number"],
    [`Chainage (${unitSymbol})`, ({ from, to }) => `${fixed(from, 2)} – ${fixed(to, 2)}`, "number"],
    ["Side", ({ side }) => kSides[side] ?? ""],
    [`Distance (${unitSymbol})`, (obstacle) => change(obstacle, leastOf), "number"],
    ["Points", (obstacle) => change(obstacle, pointsOf), "number"],
    ["Place x, y, z", ({ middle }) => coordinates(middle), "number"],
    ["Note", ({ note }) => note, "text"]]);
  const rows = (some) => itemTable("Obstacles", columns, some, ({ number }) => ({ id: `row${number}` }), "tall");
  const same = obstacles.filter(isSame), few = same.length <= 10, others = few ? obstacles : obstacles.filter((one) => !isSame(one));
  byId("obstacles-body").append(others.length > 0 ? rows(others) : "", few ? "" : make("details", {},
      make("summary", {}, `${plural(same.length, "obstacle")} that are the same in both`), rows(same)));
}

startPage(async () => {}, [buildComparison, buildQuestion, buildPathPlan, buildObstacles]);
