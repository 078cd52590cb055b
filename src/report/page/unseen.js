// Places that the vehicle sweeps and that no beam of the scanner passed through: what they mean, the
// table of their groups, and how they are drawn.

const kUnseenColour = "#5b21b6", kUnseenRgb = [91, 33, 182];
const kShownGroups = 200, kPrintedGroups = 40;

/** What is known of seen space; null where the run did not ask for it. */
const seenFacts = () => page.facts.seen ?? null;
/** The listed groups, the largest first; they are named by this order. */
const unseenGroups = () => page.unseenGroups ??= [...(seenFacts()?.list ?? [])]
    .sort((a, b) => b.cubes - a.cubes || a.id - b.id);
const groupName = (group) => `U${unseenGroups().indexOf(group) + 1}`;
const isNotScanned = () => (seenFacts()?.listed_groups ?? 0) > 0;

/** " that was scanned", where places were not scanned of which nothing is known. */
const scannedOnly = () => isNotScanned() ? " that was scanned" : "";

function selectGroup(group) {
  page.group = group;
  page.pose = shownPose(group.first_pose);
  notify("pose");
  notify("group");
}

/** "3.2 of 68.0 m". What would round to 0 is less than 0.1, because it is not nothing. */
function notScannedWords() {
  const part = seenFacts().not_scanned_length;
  return `${part < 0.05 ? "less than 0.1" : part.toFixed(1)} of ` +
      `${page.facts.inputs.trajectory.length.toFixed(1)} ${unitSymbol}`;
}

/** What beams passed through, and where nobody knows what is there; empty where that was not asked. */
function scannedSentence() {
  const groups = unseenGroups(), largest = groups.length > 1 ? ", the largest place," : "";
  return page.facts.words.seen +
      (isNotScanned() ? ` Anything may stand there: see ${groupName(groups[0])}${largest} below.` : "");
}

/** Where a group lies, seen from the path: ranges along an axis of its box there. */
const rangeCell = ({ seen }, axis) => seen ? span(signed(seen.lo[axis]), signed(seen.hi[axis]), " to ") : "";

function groupColumns() {
  return columnsOf([
    ["No.", groupName],
    ["Cubes", (g) => count(g.cubes), "number"],
    [`Size (${unitSymbol})`, sizeCell, "number"],
    [`Chainage (${unitSymbol})`, chainageCell, "number"],
    ["Side", (g) => kSides[g.side]],
    [`Lateral (${unitSymbol})`, (g) => rangeCell(g, 1), "number"],
    [`Height (${unitSymbol})`, (g) => rangeCell(g, 2), "number"],
    seenFacts().behind_conflicts > 0 && ["Behind a conflict", (g) => g.behind_conflict ? "yes" : "no"],
    [`Middle x, y, z (${unitSymbol})`, (g) => coordinates(g.middle), "number"],
    ["In the result", (g) => `group ${count(g.id)}`, "number"],
    ["What to do", groupAdvice],
  ]);
}

/** What most probably explains a group, and what would decide it. */
function groupAdvice(group) {
  if (group.is_ground) return "the ground? --floor";
  if (group.is_sky) return "open sky? --ignore-box";
  if (group.behind_conflict) return "clear the conflict, scan again";
  return "scan it from another place";
}

const groupTable = (groups, how) => itemTable("Places that were not scanned", groupColumns(), groups, how);

function markGroupRow() {
  for (const row of document.querySelectorAll("#unseen-table tbody tr")) {
    row.classList.toggle("chosen", row.dataset.group === String(page.group?.id));
  }
  byId("unseen-chosen").replaceChildren(...chosenGroup());
}

/** What the chosen group is, in words, and a way to see it. */
function chosenGroup() {
  const group = page.group;
  if (!group) return [];
  const side = sideWords(group.side), seen = group.seen;
  const span = (lo, hi, minus, plusWord) => `${metres(Math.abs(lo), 2)} ${lo < 0 ? minus : plusWord} to ` +
      `${metres(Math.abs(hi), 2)} ${hi < 0 ? minus : plusWord}`;
  const where = seen ? ` Seen from the path, the middles of its cubes lie from ` +
      `${span(seen.lo[1], seen.hi[1], "right", "left")}, and from ` +
      `${span(seen.lo[2], seen.hi[2], "below", "above")}.` : "";
  const behind = group.behind_conflict
      ? " A colliding point lies in it or next to it, so what collides may hide it from the scanner." : "";
  return [make("p", {}, make("strong", {}, `${groupName(group)}: `),
      `${plural(group.cubes, "cube")} that no beam passed through. The vehicle first reaches it at ` +
      `chainage ${placeWords(group.chainage_from)} (pose ${count(group.first_pose)})${after(side)}, ` +
      `and its last cube at ${placeWords(group.chainage_to)}.${where}${behind}`),
      button("Show in 3-D", () => showInView(group.first_pose, flyToGroup))];
}

/** What can be done about all that was not scanned, one sentence for each kind of group. */
function adviceSentences() {
  const groups = unseenGroups(), seen = seenFacts(), out = [];
  const names = (list) => joined([...list.slice(0, 5).map(groupName),
                                  ...(list.length > 5 ? [`${count(list.length - 5)} more`] : [])]);
  const ground = groups.filter((g) => g.is_ground), sky = groups.filter((g) => g.is_sky);
  const behind = groups.filter((g) => g.behind_conflict && !g.is_ground && !g.is_sky);
  const others = groups.filter((g) => !g.behind_conflict && !g.is_ground && !g.is_sky);
  const goes = (list) => list.length === 1 ? "goes" : "go";
  if (ground.length > 0) {
    const least = shortLength(+((page.facts.margins?.clear ?? 0) + seen.cube / 2).toPrecision(3));
    out.push(["The ground", `${names(ground)} ${goes(ground)} along more than half of the path and ` +
        `${ground.length === 1 ? "reaches" : "reach"} down to the lowest part of the vehicle. That is usually ` +
        "the ground it stands on, into which no beam can look, perhaps joined with other places. " +
        `Run again with a --floor that is ${least} above the vehicle's lowest part, which is half a cube` +
        `${page.facts.margins ? " and the errors" : ""}, and a little more where the ground is rough. ` +
        "Then none of the ground is judged."]);
  }
  if (sky.length > 0) {
    out.push(["The open sky", `${names(sky)} ${goes(sky)} along more than half of the path in the upper ` +
        "part of the vehicle. No beam comes back from the open sky, so a scan cannot show that nothing " +
        "is there. If you know that it is open, leave the place out with --ignore-box."]);
  }
  if (behind.length > 0) {
    out.push(["Behind a conflict", `${names(behind)} ${behind.length === 1 ? "holds" : "hold"} or ` +
        `${behind.length === 1 ? "touches" : "touch"} a cube with a colliding point. What collides may hide ` +
        "what lies behind it from the scanner. Clear the conflict, and then scan again."]);
  }
  if (others.length > 0) {
    out.push(["Other places", `Scan ${names(others)} from where the scanner looks into ` +
        `${others.length === 1 ? "it" : "them"}, or look there yourself. If you know that nothing is ` +
        "there, --ignore-box leaves the place out."]);
  }
  return out;
}

function unseenNote() {
  const seen = seenFacts();
  if (!isNotScanned()) return scannedSentence();
  return "Unseen cubes that touch each other are one place, and the largest place is U1. Lateral is how far left (+) or right (−) of " +
      "the path the middles of its cubes lie when the vehicle first reaches them, height how far above " +
      "the path, along the vehicle's own axes." +
      (seen.list.length < seen.listed_groups
          ? ` This page lists the ${count(seen.list.length)} largest of ${count(seen.listed_groups)}.` : "");
}

function buildUnseen() {
  if (!seenFacts()) {
    removePart("unseen");
    return;
  }
  byId("unseen-note").append(make("p", {}, unseenNote()));
  if (seenFacts().unseen > 0) buildFront();
  if (!isNotScanned()) return;
  byId("unseen-advice").append(...adviceSentences().map(([title, text]) =>
      make("li", {}, make("strong", {}, `${title}. `), text)));
  const groups = unseenGroups(), shown = groups.slice(0, kShownGroups);
  byId("unseen-table").append(groupTable(shown, (group) =>
      ({ ...chosenBy(() => selectGroup(group)), "data-group": group.id })));
  if (shown.length < groups.length) {
    byId("unseen-table").append(make("p", { class: "note" },
        `The ${count(shown.length)} largest of ${count(groups.length)} are in the table.`));
  }
  on("group", markGroupRow);
}

/** The rows that paper has. */
function printedGroups() {
  const groups = unseenGroups(), shown = groups.slice(0, kPrintedGroups);
  return [groupTable(shown), shown.length < groups.length &&
      make("p", { class: "note" }, `${plural(groups.length - shown.length, "more place")} not on paper.`)];
}

/** Shaded stretches of the profile on which something was not scanned. */
const profileNotScanned = () => profile.shaded((seenFacts()?.stretches ?? []).map(([from, to]) => ({ from, to, kind: "not-scanned",
    words: "not scanned", title: `Not scanned: chainage ${from.toFixed(2)} to ${to.toFixed(2)}` })), 90);

const notScannedPattern = () => hatching("not-scanned", 12, -45, "#f3effc", ["#a78bda", 1.4]);

/** What the shading of stretches that were not scanned means, in words below the profile. */
function notScannedLegend() {
  const stretches = (seenFacts()?.stretches ?? []).map(([from, to]) =>
      ({ chainage_from: from, chainage_to: to }));
  if (stretches.length === 0) return [];
  return [make("li", {}, swatch("not-scanned", kUnseenColour),
      ` Not scanned: at chainage ${stretchWords(stretches)} the vehicle reaches places that no beam ` +
      "passed through. The curve knows nothing of them.")];
}

/** The unseen cubes, hatched, so that they differ from points without their colour. */
function paintUnseen(context, painter, unitSize) {
  if (!page.unseen) return;
  const period = Math.round(7 * unitSize), [r, g, b] = kUnseenRgb;
  const half = Math.max(1, Math.round(0.5 * seenFacts().cube * painter.perMetre));
  const square = Array.from({ length: 2 * half + 1 }, (_, i) => [i - half, half]);
  drawMask(context, maskOf(painter, placesOf(page.unseen), square), painter.width, painter.height,
           (x, y, isEdge) => [r, g, b, isEdge ? 255 : (x + y) % period < 0.35 * period ? 200 : 60]);
}

/** Squares with the groups' numbers, for plan and 3-D view. */
function groupMarks() {
  return unseenGroups().map((group, i) => ({
    place: inPage(group.middle), text: groupName(group), shape: "square", colour: kUnseenColour,
    hollow: false, chosen: group === page.group, first: i === 0 || group === page.group, rank: i + 1.5,
    select: () => selectGroup(group),
  }));
}

/** What hollow marks and hatched places mean, where there are any. */
function marksNote() {
  return (conflictList().some(isPossible) ? " A hollow mark is a possible conflict, a filled one is certain." : "") +
      (isNotScanned() ? " Hatched places, with numbers that begin with U, were not scanned." : "");
}
