function tile(value, label, action) {
  const content = [make("strong", {}, value), make("span", {}, label, action ?
      make("span", { class: "on-screen" }, ". Show it") : null)];
  return action ? make("button", { type: "button", class: "tile", onclick: action }, ...content)
                : make("div", { class: "tile" }, ...content);
}

function goTo(conflict) {
  selectConflict(conflict);
  byId("conflicts").scrollIntoView();
}

/** The number of conflicts; where all groups are too small to be listed, that of these. */
function conflictsTile({ count: listed, small_groups: small }) {
  if (listed > 0 || small === 0) return tile(count(listed), listed === 1 ? "conflict" : "conflicts");
  return tile(count(small), `${small === 1 ? "place" : "places"}, too small for the list`);
}

/** How many conflicts the ledger accepts. */
function acceptedTiles() {
  const ledger = ledgerFacts(), all = page.facts.conflicts?.count ?? 0;
  if (!ledger || all === 0) return [];
  return [tile(`${count(ledger.accepted_conflicts)} of ${count(all)}`, "accepted by the ledger",
               () => byId("conflicts").scrollIntoView())];
}

function conflictTiles() {
  const { facts } = page, worst = worstConflict(), tiles = [];
  if (facts.conflicts) tiles.push(conflictsTile(facts.conflicts), ...acceptedTiles(), ...certaintyTiles());
  const points = facts.colliding_points;
  tiles.push(tile(count(points), points === 1 ? "colliding point" : "colliding points"));
  if (worst) {
    const inside = insidePoints();
    if (inside > 0) tiles.push(tile(count(inside), "of them inside the vehicle"));
    tiles.push(worstTile(worst));
    tiles.push(tile(`No. ${worst.id}`,
                    `worst: chainage ${placeWords(stationOf(worst))}` +
                    after(isInside(worst.least_distance) ? innerSideWords(worst.side) : kSides[worst.side]),
                    () => goTo(worst)));
  }
  return tiles;
}

/** On how much of the path nobody knows what is there; nothing where that is none of it. */
function scannedTiles() {
  if (!isNotScanned()) return [];
  return [tile(page.facts.inputs.trajectory.length > 0 ? notScannedWords() : plural(seenFacts().listed_groups, "place"),
               page.facts.inputs.trajectory.length > 0 ? "of the path not scanned" : "not scanned",
               () => byId("unseen").scrollIntoView())];
}

/** Of a conflict or an undecided run with a budget: how many conflicts are certain, how many possible. */
function certaintyTiles() {
  const list = conflictList(), possible = list.filter(isPossible).length, worst = worstConflict();
  if (possible === 0) return [];
  return [tile(count(possible), `of them possible, ${count(list.length - possible)} certain`,
               () => goTo(worst))];
}

/** How bad the worst conflict is, and on which side. */
function worstTile({ points, encroachment, encroachment_is: bound, least_distance: distance, side }) {
  const where = after(sideOfPlace({ side, least_distance: distance }));
  if (encroachment === null) return tile(plural(points, "point"), `in the worst conflict${where}`);
  if (isInside(distance)) return tile(metres(-distance), `deepest inside the vehicle${where}`);
  const words = missingWords(encroachment, distance, bound);
  if (words === "") return tile(metres(distance), `away at the worst place${where}`);
  return words === "touches" ? tile("touches", `the vehicle at the worst place${where}`)
                             : tile(words, `missing at the worst place${where}`);
}

function clearTiles() {
  const { least_distance: least, query, inputs } = page.facts, tiles = [];
  if (least) {
    tiles.push(tile(metres(least.distance), `least distance found${after(sideWords(least.side))}`));
    tiles.push(tile(station(least.chainage), `chainage of it${besideChainage(least.chainage)}`, () => {
      selectPose(shownPose(least.pose));
      byId("view").scrollIntoView();
      notify("overview");
    }));
  } else if (Math.max(query.clearance, query.profile) > 0) {
    tiles.push(tile(`over ${shortLength(Math.max(query.clearance, query.profile))}`,
                    `least distance: nothing${scannedOnly()} is closer`));
  } else {
    tiles.push(tile("not known", "least distance, see below"));
  }
  if (page.facts.verdict === "undecided" && conflictList().length > 0) {
    const possible = conflictList().length;
    tiles.push(tile(count(possible), possible === 1 ? "possible conflict" : "possible conflicts", () => goTo(worstConflict())));
  }
  const { length, searched_length: searched } = inputs.trajectory;
  tiles.push(tile(station(searched), searched < length ? `of ${station(length)} of path searched`
                                                       : "path searched"));
  return tiles;
}

/** " at 3 places", and how many more the table leaves out. */
function placesText({ count: listed, small_groups: small, first_small: first }) {
  if (listed === 0) {
    return ` at ${plural(small, "place")}, too small for the list` + (first
        ? `; ${small === 1 ? "it has" : "the first has"} ${plural(first.points, "point")} at ` +
          `chainage ${placeWords(first.chainage_from)}. --min-points 1 lists ${small === 1 ? "it" : "them"}`
        : "");
  }
  const more = small > 0 ? ` and at ${count(small)} more that are too small for the list` : "";
  return ` at ${plural(listed, "place")}${more}`;
}

/** What is missing at a conflict, as the end of a sentence; nothing where it is not known. */
function nearnessText({ encroachment, encroachment_is: bound, least_distance: distance, side }, radius) {
  if (encroachment === null) return "";
  if (isInside(distance)) return `: ${depthWords(distance)} inside the vehicle${after(innerSideWords(side))}`;
  const words = missingWords(encroachment, distance, bound);
  if (words === "") return `: ${metres(distance)} away, which is too close only with the errors`;
  return words === "touches" ? ": it touches the vehicle" : `: ${words} of ${radius} are missing`;
}

/** What the points are classified as, where that says anything. */
const classifiedText = ({ classified }) => classified ? ` ${classified}.` : "";

/** Where the worst conflict is, and what can be done about it. */
function worstSentence(worst, radius) {
  const place = worst.least_distance === null ? "" :
      nearestPointSentence({ ...worst, point: worst.nearest_point, side: "unknown" }, worst.least_distance);
  return `The worst place is conflict ${worst.id}, at chainage ${placeWords(stationOf(worst))}` +
      `${isInside(worst.least_distance) ? "" : after(sideWords(worst.side))}${bodyWords(worst)}` +
      `${nearnessText(worst, radius)}.${place}` +
      (page.facts.conflicts.count > 1 ? classifiedText(worst) : "") +
      (worst.remedy ? ` ${worst.remedy}` : "");
}

/** Which conflict is the worst of those that are not accepted, where that is not the worst of all. */
function ledgerWorstSentence() {
  const worst = worstOutside();
  if (!worst || worst === worstConflict() || page.facts.verdict !== "conflict") return "";
  return ` The worst that is not accepted is conflict ${worst.id}, at chainage ${placeWords(stationOf(worst))}` +
      `${after(sideOfPlace(worst))}${bodyWords(worst)}.`;
}

const isSolid = () => page.facts.inputs.model.solids > 0;
/** Whether every body has an inside. */
const isAllSolid = () => page.facts.inputs.model.bodies?.every((b) => b.solids > 0) ?? isSolid();

/** How many points were inside the vehicle at any pose; null where that is not known. */
const insidePoints = () => page.facts.inside === null ? null : page.facts.inside.points;

function insideText() {
  const inside = insidePoints();
  if (inside === null) return "";
  if (inside === 0) return " No point is inside it.";
  return ` ${plural(inside, "point")} ${inside === 1 ? "is" : "are"} inside it.`;
}

/** The part of a normal distribution that lies beyond so many standard deviations on one side. */
function tail(sigmas) {
  let sum = 0;
  const step = 0.001;
  for (let x = sigmas + step / 2; x < sigmas + 12; x += step) sum += Math.exp(-0.5 * x * x) * step;
  return sum / Math.sqrt(2 * Math.PI);
}

const percent = (share) => `${+(100 * share).toPrecision(2)} %`;

/** What the answer about seen space rests on. */
function seenBasis() {
  const seen = seenFacts();
  const origins = seen.origins.map((o) => `${o.what} (${plural(o.points, "point")})`);
  const without = seen.points_without_origin;
  return [`Seen space: ${plural(seen.places, "place")} of the scanner, from ${joined(origins)}.` +
          (without > 0 ? ` Of ${plural(without, "point")} nobody said where the scanner stood, so ` +
                         "their beams show nothing." : "") +
          " If these places are wrong, places count as seen that nobody saw.",
          `Cubes of ${shortLength(seen.cube)}, each of which a beam passed through in its inner half, so ` +
          `beams may be wrong by up to ${shortLength(+(seen.cube / 4).toPrecision(3))}.`];
}

/** What the errors of the budget make sure of. */
function budgetBasis({ budget, margins }) {
  const one = tail(budget.sigmas);
  return [`The errors below, at ${budget.sigmas} standard deviations, which add ` +
          `${shortLength(margins.clear)} to the distance to keep.`,
          `The risk is per place: something exactly at the limit is missed with a risk of ${percent(one)} ` +
          `at one place, and of ${percent(1 - (1 - one) ** 100)} at one of a hundred such places.`];
}

/** What the verdict rests on and what it does not cover, for runs that ask how sure it is. */
function basisOfVerdict() {
  const { facts } = page, seen = seenFacts();
  if (!seen && !facts.budget) return "";
  const rests = [`The scan: ${plural(facts.inputs.environment.points, "point")} of ` +
                 `${plural(facts.inputs.environment.scans.files, "file")}, as things stood on that day.`,
                 ...(facts.budget ? budgetBasis(facts)
                     : ["No error budget: points, path and vehicle are taken as exact."]),
                 ...(seen ? seenBasis()
                     : ["Places that no beam of the scanner reached count as free. Only a run with " +
                        "--seen looks for them."])];
  const open = ["What changed after the scan.",
                "Thin, clear and shiny things that a scanner misses: wires, glass, mirrors.",
                "Errors that no budget names: a wrong unit, a part that the model lacks, outliers."];
  const list = (title, texts) => make("div", {}, make("h3", {}, title),
                                      make("ul", {}, texts.map((text) => make("li", {}, text))));
  return make("div", { class: "columns basis", id: "basis" },
              list("What this verdict rests on", rests), list("What it does not cover", open));
}

/** The error that adds most to the distance to keep, and what makes it smaller. */
function largestError({ budget: b, query }) {
  const measured = "a better measurement makes it smaller";
  const all = [
    [b.sigmas * b.scan, "the error of single points", measured],
    [b.sigmas * b.registration, "the error of the registration", measured],
    [b.sigmas * b.pose, "the error of the poses", measured],
    [b.sigmas * b.angle * b.lever, "the error of the angles", measured],
    [b.model, "the error of the model", "a better model makes it smaller"],
    [b.motion + b.chord, "what lies between two poses",
     query.between_poses ? "more poses make it smaller" : "--between-poses or more poses make it smaller"],
    [b.spacing, "the spacing of the model's points", "--model-as surface searches the mesh as it is"],
  ];
  const [size, name, help] = all.reduce((most, one) => one[0] > most[0] ? one : most);
  return size > 0 ? ` Of the errors, ${name} is the largest, with ${shortLength(+size.toPrecision(3))}: ${help}.` : "";
}

/** For each reason of an undecided verdict, where to look and what would decide it. */
function whatDecides() {
  const { facts } = page, possible = conflictList().filter(isPossible).length;
  if (facts.verdict !== "undecided") return "";
  const where = possible > 0
      ? `the ${plural(possible, "possible conflict")} in the table below` : "the points in plan and 3-D view";
  const words = {
    "near": () => `Points are near: look at ${where}, or make the errors smaller.${largestError(facts)}`,
    "few": () => "Points are certainly too close, but no ten of them hang together: look whether they are " +
        "noise, or scan the place more densely.",
    "errors-exceed-margin": () => "The errors exceed the margin, so that a surface can be near but never a certain " +
        "conflict: make the errors smaller, or search a closed mesh with --model-as solid.",
    "not-scanned": () => `Places were not scanned: see ${groupName(unseenGroups()[0])}` +
        `${unseenGroups().length > 1 ? " and others" : ""} below, each with what to do about it.`,
    "question-in-doubt": () => `The question is in doubt: correct what the warnings ${facts.doubts.join(", ")} name and ` +
        "run it again, or have the stretches of the path that they name scanned or inspected.",
  };
  return make("div", { class: "basis", id: "decides" }, make("h3", {}, "What would decide it"),
              make("ul", {}, facts.reasons.map((reason) => make("li", {}, words[reason]()))));
}

/** The error budget as a table: what was given, what follows, and the two margins. */
function budgetTable() {
  const { budget: b, margins } = page.facts;
  if (!b) return "";
  const row = (name, value, words) => make("tr", {}, make("th", { scope: "row" }, name),
                                           make("td", {}, value), make("td", {}, words));
  const each = `standard deviation, times ${b.sigmas}`;
  return make("table", { class: "facts", id: "budget" },
    make("caption", {}, "Error budget"), make("tbody", {},
    row("Scan", shortLength(b.scan), `${each}; times 6 against a conflict`),
    row("Registration", shortLength(b.registration), each),
    row("Poses", shortLength(b.pose), each),
    row("Angles", shortLength(b.angle * b.lever),
        `${each}: ${+b.angle.toPrecision(4)} rad at ${shortLength(b.lever)} from the vehicle's origin`),
    row("Model", shortLength(b.model), "hard bound"),
    row("Steps of coordinates", metres(b.step, 4), "hard bound"),
    row("Way", shortLength(b.motion + b.chord + b.spacing),
        "what lies between poses and between points of the model; not against a conflict"),
    row("For clear", shortLength(margins.clear), "added to the margin"),
    row("For conflict", shortLength(margins.conflict), "taken from the margin")));
}

/** What was found, and where it is worst or nearest. */
function verdictSentences() {
  const { facts } = page, worst = worstConflict(), conflict = facts.verdict === "conflict";
  const open = facts.verdict === "undecided" ? `Undecided: ${facts.reason_words.join("; ")}. ` : "";
  const places = conflict && facts.conflicts
      ? ` ${facts.colliding_points === 1 ? "It lies" : "They lie"}${placesText(facts.conflicts)}.` : "";
  const first = open + facts.words.finding + places + (conflict ? insideText() : "") + classifiedText(facts);
  return [first, conflict && worst ? worstSentence(worst, shortLength(facts.query.radius)) : leastSentence()];
}

function crsName(wkt) {
  const name = /^[A-Z]+\["([^"]+)"/.exec(wkt);
  return name ? name[1] : wkt ? "named in the scans" : "none given";
}

function questionTable() {
  const { inputs, query, unit } = page.facts;
  const hash = (text) => make("code", {}, text);
  const box = inputs.model.box;
  const size = box.hi.map((h, k) => (h - box.lo[k]).toFixed(2)).join(" × ");
  return factsTable(
    ["Question", `Does anything come closer than ${shortLength(query.radius)} to the ` +
            (query.between_poses ? "vehicle, at its poses and between them?"
                                 : "vehicle, at any of its poses?")],
    ["Environment", `${inputs.environment.name}: ${count(inputs.environment.points)} points of ` +
            `${scanWords(inputs.environment.scans)}. CRS: ${crsName(inputs.environment.crs_wkt)}. ` +
            `Unit: ${unit === "unknown" ? "taken as metre" : unit}. `, hash(inputs.environment.hash)],
    inputs.model.bodies ? ["Vehicle (bodies)", bodyList(inputs.model), hash(inputs.model.hash)]
        : ["Vehicle (model)", `${inputs.model.name}: ${modelParts(inputs.model)}, ` +
           `${size} ${unitSymbol}.${solidText(inputs.model)} `, hash(inputs.model.hash)],
    ["Path", `${inputs.trajectory.name}: ${count(inputs.trajectory.poses)} poses, ` +
            `${station(inputs.trajectory.length)} long. ` +
            (inputs.trajectory.made_by ? `${capital(`made by clearway trajectory ${inputs.trajectory.made_by}`)}. ` : ""),
            hash(inputs.trajectory.hash)],
    ["Result", `${inputs.result.name}. `, hash(inputs.result.hash)],
    ["Asked for", askedFor(query)],
    page.facts.floor !== null && ["Floor", `Only what lies at ${page.facts.floor.words} or above is judged. `,
                                       make("code", {}, "--floor")],
    page.facts.ignored !== null && ["Ignored", ignoredText(page.facts.ignored)]);
}

/** What the search took the model, or a body, for. */
function modelParts({ points, triangles }) {
  return triangles > 0 ? plural(triangles, "triangle") : plural(points, "point");
}

function solidText({ solids, surface_triangles: open }) {
  if (solids === 0) return "";
  const rest = open > 0 ? `; ${plural(open, "triangle")} of its other parts have none` : "";
  return ` ${plural(solids, "closed part")} ${solids === 1 ? "has" : "have"} an inside${rest}.`;
}

/** Each with what it consists of, its size, and where it lacks poses. */
function bodyList({ name, bodies }) {
  const { poses } = page.facts.inputs.trajectory;
  return make("div", {}, `${name}: ${plural(bodies.length, "body", "bodies")}`,
              make("ul", { class: "bodies" }, bodies.map(({ box, ...body }) => make("li", {},
      make("strong", {}, body.name), `: ${modelParts(body)}, `,
      box.hi.map((h, k) => (h - box.lo[k]).toFixed(2)).join(" × "), ` ${unitSymbol}`,
      body.poses < poses ? `; it has ${count(body.poses)} of ${plural(poses, "pose")}` : "",
      body.solids > 0 ? `.${solidText(body)}` : ""))));
}

/** What --ignore-class and --ignore-box left out of the search. */
function ignoredText({ classes, boxes }) {
  const parts = classes.map((c) => `class ${c.class}${c.name ? ` (${c.name})` : ""}: ` +
                                   plural(c.points, "point"));
  const corner = (p) => p.map((v) => String(+v.toFixed(4))).join(" ");
  parts.push(...boxes.map((b) => `box ${corner(b.lo)} to ${corner(b.hi)}: ` +
                                 plural(b.points, "point")));
  return `${parts.join("; ")}.`;
}

function askedFor(query) {
  const parts = [`required distance ${shortLength(query.radius)}`];
  if (query.clearance > 0) parts.push(`clearances up to ${shortLength(query.clearance)}`);
  if (query.profile > 0) parts.push(`profile up to ${shortLength(query.profile)}`);
  parts.push(query.first_pose ? "first poses" : "no first poses");
  return parts.join(", ");
}

function legend() {
  const rows = page.facts.classes.map((c, k) => {
    const words = kClassWords[c.name], from = k > 0 ? page.facts.classes[k - 1].below : 0;
    const range = k > 0 ? `${shortLength(from)} to ${shortLength(c.below)}`
                        : `below ${shortLength(c.below)}`;
    const inside = k === 0 && insidePoints() > 0 ? `, ${count(insidePoints())} of them inside` : "";
    const thinned = c.shown < c.points ? `, of which ${count(c.shown)} are drawn` : "";
    return make("li", {}, make("span", { style: `color:${words.colour}`, class: "symbol" },
                               words.symbol),
                ` ${c.name}: ${range}, ${plural(c.points, "point")}${inside}${thinned}`);
  });
  return make("ul", { class: "legend" }, rows,
              make("li", {}, make("span", { style: `color:${kModelColour}`, class: "symbol" }, "■"),
                   " vehicle"),
              make("li", {}, make("span", { style: "color:#7a828c", class: "symbol" }, "■"),
                   " environment"),
              isNotScanned() && make("li", {}, make("span", { style: `color:${kUnseenColour}`, class: "symbol" },
                                                    "▨"), " not scanned, with numbers U1, U2, …"),
              conflictList().some(isPossible) &&
                  make("li", {}, "● a filled number is a certain conflict, ○ a hollow one a possible one"));
}

function buildVerdict() {
  const { facts } = page, conflict = facts.verdict === "conflict";
  const [first, second] = verdictSentences(), warned = page.facts.warnings.map((w) => asSentence(w.message)), missing = missingParts();
  const { spacing, doubt, floor, ignored } = facts.words;
  const lines = [["ignored", ignored], ["below-floor", floor], ["finding", first], ["place", second],
                 ["ledger-sentence", ledgerSentence() + ledgerWorstSentence()], ["spacing", spacing],
                 ["scanned", scannedSentence()], ["searched", searchedSentence()], ["not-found", doubt]];
  byId("verdict-body").append(
    answerBanner({ kind: facts.verdict, word: capital(facts.verdict_words), lines: [
          ...lines.filter(([, text]) => text).map(([id, text]) => make("p", { id }, text)),
          seeWarnings(conflict ? "See also" : "See", warned)] }),
    make("div", { class: "tiles" }, scannedTiles(), conflict ? conflictTiles() : clearTiles()),
    warningsList(warned),
    whatDecides(),
    basisOfVerdict(),
    vehicleBox(),
    make("div", { class: "columns" }, facts.budget ? make("div", {}, questionTable(), budgetTable()) : questionTable(),
         make("div", {}, legend(),
              missing.length > 0 && make("div", { class: "missing" },
                  make("p", {}, "This page could say more:"),
                  make("ul", {}, missing.map((m) => make("li", {}, `${m.what}: ${m.why}. `,
                                                         make("code", {}, m.how), " adds it.")))))));
}
