// The page of a section: the answer first, then the parts.

const kSectionVerdicts = { passes: ["Passes", "clear"], stopped: ["Stopped", "conflict"], unknown: ["Unknown", "undecided"] };

function answerBanner() {
  const { check, sentence } = section.facts, { warnings } = page.facts;
  const [word, kind] = check ? kSectionVerdicts[check.verdict] : ["Largest load", "undecided"];
  const doubtful = kind === "clear" && warnings.length > 0;
  const told = check ? sentence.slice(sentence.indexOf(": ") + 2) : sentence;
  return make("div", { class: `banner ${doubtful ? "doubt" : check ? kind : "plain"}` },
      check && (doubtful ? doubtSymbol() : verdictSymbol(kind)),
      make("div", { class: "words" }, make("h2", { id: "verdict-word" }, doubtful ? `${word}, but doubtful` : word),
           make("p", { id: "answer" }, `${capital(told)}.`),
           warnings.length > 0 && make("p", { class: "but" }, `See ${plural(warnings.length, "warning")} below.`)));
}

function buildAnswer() {
  const { facts } = page;
  byId("made").textContent = [facts.date && `Made ${facts.date}`, `by Clearway ${facts.clearway}`].filter(Boolean).join(" ");
  byId("about").append(...["project", "client", "author"].filter((key) => facts[key]).map((key) =>
      make("span", {}, `${capital(key)}: `, make("strong", {}, facts[key]))));
  byId("loading").remove();
  byId("verdict-body").append(answerBanner(), facts.warnings.length > 0
      ? make("ul", { class: "warnings", "aria-label": "Warnings" },
             facts.warnings.map((w) => make("li", {}, `${capital(w.message)}.`))) : "", onSiteBox());
}

/** A table of names and values. */
function factsTable(rows) {
  return make("table", { class: "facts" }, make("tbody", {}, rows.map(([name, value]) =>
      make("tr", {}, make("th", { scope: "row" }, name), make("td", {}, value)))));
}

/** What no file can prove, for a person to compare with the load and the route. */
function onSiteBox() {
  const { rear, front, pivots, length, load_poses: poses } = section.facts;
  const from = (x) => `${station(Math.abs(x))} ${x < 0 ? "behind" : "ahead of"}`;
  return make("div", { class: "basis", id: "on-site" }, make("h3", {}, "Check these on site"),
      make("p", { class: "note" }, "No file shows whether these are right. Compare them with the load and the place."),
      factsTable([
        ["Load", `${station(front - rear)} long, from ${from(rear)} to ${from(front)} ` +
            (pivots ? "its origin" : "the path's pose")],
        pivots && ["Pivots", `${station(Math.abs(pivots[0] - pivots[1]))} apart, ${from(pivots[0])} and ` +
            `${from(pivots[1])} the path's pose`],
        ["Path", `${station(length)} long, with ${plural(poses, "pose")} of the load; left is left when looking ` +
            "from its beginning to its end"]].filter(Boolean)));
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
  byId("question-body").append(factsTable(rows));
  byId("footer").textContent = "All data of this page is in this one file. Lengths are in the unit of the scans " +
      `(${unitSymbol}). Chainage counts from the first pose along the path.`;
}

async function startSection() {
  if (typeof DecompressionStream === "undefined") {
    throw new Error("This browser is too old for this page: it needs DecompressionStream " +
                    "(Chromium 80, Firefox 113, Safari 16.4, or later).");
  }
  await readSection();
  for (const build of [buildAnswer, buildSection, buildStops, buildWidths, buildQuestion]) build();
  byId("print-page").addEventListener("click", () => window.print());
  window.addEventListener("beforeprint", () => chooseStretch(section.chosen));
  document.body.dataset.ready = "true";
}

startSection().catch((error) => {
  const holder = byId("loading") ?? byId("verdict-body");
  holder.className = "problem";
  holder.textContent = error.message;
  document.body.dataset.ready = "failed";
  console.error(error);
});
