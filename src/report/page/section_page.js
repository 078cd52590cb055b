// The page of a section: the answer first, then the parts.

const kSectionVerdicts = { passes: ["Passes", "clear"], stopped: ["Stopped", "conflict"], unknown: ["Unknown", "undecided"] };

function buildAnswer() {
  const { check, sentence } = section.facts, { warnings } = page.facts;
  const [word, kind] = check ? kSectionVerdicts[check.verdict] : ["Largest load", "plain"];
  const text = check ? sentence.slice(sentence.indexOf(": ") + 2) : sentence;
  byId("verdict-body").append(
      answerBanner({ kind, word, doubtful: kind === "clear" && warnings.length > 0, lines: [
        make("p", { id: "answer" }, `${capital(text)}.`), seeWarnings("See", warnings)] }),
      warningsList(warnings.map((w) => `${capital(w.message)}.`)), loadBox());
}

/** The numbers of the load and its path. */
function loadBox() {
  const { rear, front, pivots, length, load_poses: poses } = section.facts;
  const from = (x) => `${station(Math.abs(x))} ${x < 0 ? "behind" : "ahead of"}`;
  return compareOnSite("the load and the place",
      factRow("Load", `${station(front - rear)} long, from ${from(rear)} to ${from(front)} ` +
          (pivots ? "its origin" : "the path's pose")),
      pivots ? factRow("Pivots", `${station(Math.abs(pivots[0] - pivots[1]))} apart, ${from(pivots[0])} and ` +
          `${from(pivots[1])} the path's pose`) : "",
      factRow("Path", `${station(length)} long, with ${plural(poses, "pose")} of the load; left is left when looking ` +
          "from its beginning to its end"));
}

function buildQuestion() {
  const f = section.facts, { check } = f;
  const rows = [
    f.name && ["Section", f.name],
    ["Load", `from x = ${shortLength(f.rear)} to ${shortLength(f.front)} along the vehicle` +
        (f.pivots ? `, on pivots at ${f.pivots.map(shortLength).join(" and ")}` : "")],
    check && ["Outline", `${check.outline_name ? `${check.outline_name}, ` : ""}${plural(check.outline.length, "corner")}, margin ${shortLength(check.margin)}`],
    ["Cells", `${shortLength(f.cell)}, in stretches of ${shortLength(f.bin)}`],
    ["Margin at most", shortLength(f.margin)],
    ["Between poses", f.between_poses ? "counts, too" : "does not count"],
    ["Points", `${count(f.points)}, of which ${count(f.ignored_points)} were left out (${f.ignored})` +
        (f.ignored_cells === null ? "" : `; they alone would block ${plural(f.ignored_cells.blocked, "cell")}`)],
    ["Poses", `${count(f.load_poses)} of ${count(f.poses)} on ${station(f.length)} of path`],
    ["Environment", make("code", {}, f.environment_hash)], ["Path", make("code", {}, f.trajectory_hash)],
  ].filter(Boolean);
  byId("question-body").append(factsTable(...rows.map(([name, value]) => factRow(name, value))));
}

window.addEventListener("beforeprint", () => chooseStretch(section.chosen));
startPage(readSection, [buildAnswer, buildSection, buildStops, buildWidths, buildQuestion]);
