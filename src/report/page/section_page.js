// The page of a section: the answer first, then the parts.

const kSectionVerdicts = { passes: ["Passes", "clear"], stopped: ["Stopped", "conflict"], unknown: ["Unknown", "undecided"] };

function buildAnswer() {
  const { check, sentence } = section.facts, { warnings } = page.facts;
  const [name, kind] = check ? kSectionVerdicts[check.verdict] : ["Largest load", "plain"];
  const word = kind === "clear" && warnings.length > 0 ? `${name} with warnings` : name;
  const text = check ? sentence.slice(sentence.indexOf(": ") + 2) : sentence;
  byId("verdict-body").append(
      answerBanner({ kind, word, lines: [
        make("p", { id: "answer" }, asSentence(text)), seeWarnings("See", warnings)] }),
      warningsList(warnings.map((w) => asSentence(w.message))), loadBox());
}

/** The numbers of the load and its path. */
function loadBox() {
  const { rear, front, pivots, length, load_poses: poses } = section.facts;
  const from = (x) => `${station(Math.abs(x))} ${x < 0 ? "behind" : "ahead of"}`;
  return compareOnSite("the load and the place",
      ["Load", `${station(front - rear)} long, from ${from(rear)} to ${from(front)} ` +
          (pivots ? "its origin" : "the path's pose")],
      pivots && ["Pivots", `${station(Math.abs(pivots[0] - pivots[1]))} apart, ${from(pivots[0])} and ` +
          `${from(pivots[1])} the path's pose`],
      ["Path", `${station(length)} long, with ${plural(poses, "pose")} of the load; left is left when looking ` +
          "from its beginning to its end"]);
}

function buildQuestion() {
  const f = section.facts, { check } = f;
  const rows = [
    f.name && ["Section", f.name],
    ["Load", `from x = ${shortLength(f.rear)} to ${shortLength(f.front)} along the vehicle` +
        (f.pivots ? `, on pivots at ${f.pivots.map(shortLength).join(" and ")}` : "")],
    check && check.rows.length === 0 && ["Outline", loadWords(check.loads[0])],
    check && check.rows.length > 0 && ["Outlines", `${plural(check.rows.length, "row")}, see the table below`],
    ["Cells", `${shortLength(f.cell)}, in stretches of ${shortLength(f.bin)}`],
    ["Margin at most", shortLength(f.margin)],
    ["Between poses", f.between_poses ? "counts, too" : "does not count"],
    ["Points", `${count(f.points)}, of which ${count(f.ignored_points)} were left out (${f.ignored})` +
        (f.ignored_cells === null ? "" : `; they alone would block ${plural(f.ignored_cells.blocked, "cell")}`)],
    ["Poses", `${count(f.load_poses)} of ${count(f.poses)} on ${station(f.length)} of path`],
    ["Environment", f.environment_name && `${f.environment_name}${f.scans ? `: ${scanWords(f.scans)}` : ""} `, make("code", {}, f.environment_hash)],
    ["Path", f.trajectory_name && `${f.trajectory_name} `, make("code", {}, f.trajectory_hash)],
  ];
  byId("question-body").append(factsTable(...rows));
  if (check && check.rows.length > 0) byId("question-body").append(...outlinesTable(check));
}

const loadWords = ({ outline_name: name, outline, margin }) =>
    `${name ? `${name}, ` : ""}${plural(outline.length, "corner")}, margin ${shortLength(margin)}`;

/** Which outline is judged on which part of the path, and parts without one. */
function outlinesTable({ rows, gaps, loads }) {
  const parts = [...rows, ...gaps].sort((a, b) => a.chainage_from - b.chainage_from);
  const columns = columnsOf([
    [`Chainage (${unitSymbol})`, (p) => rangeWords([p.chainage_from, p.chainage_to]), "number"],
    ["Line", (p) => p.line ?? "", "number"],
    ["Outline", (p) => p.line ? loadWords(loads[p.load]) : "none"],
    ["Verdict", (p) => p.line ? p.verdict ?? "not judged" : "unknown"],
    ["Why", (p) => p.reason ?? "the table has no outline here", "text"],
  ]);
  return [make("h3", {}, "Outlines by stretch"), itemTable("Outlines by stretch", columns, parts, undefined, "tall")];
}

window.addEventListener("beforeprint", () => chooseStretch(section.chosen));
startPage(readSection, [buildAnswer, buildSection, buildStops, buildWidths, buildQuestion]);
