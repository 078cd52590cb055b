// The least distance of every pose against chainage, with the required distance and the conflicts.

const profile = new Chart(68);
profile.onPaper = false;
const profileX = (chainage) => profile.x(chainage);
const profileY = (distance) => profile.y(Math.min(distance, profile.high));

function profileTop() {
  const { query, margins } = page.facts;
  return Math.max(1.25 * query.radius, 1.1 * (query.radius + (margins?.clear ?? 0)), query.profile > 0 ? query.profile : query.clearance);
}

/** 0, or the greatest depth inside the vehicle with some room below it. */
function profileLow() {
  let least = 0;
  for (let i = 0; page.poses.distance && i < page.poses.count; ++i) {
    least = Math.min(least, distanceAt(i) ?? 0);
  }
  return 1.08 * least;
}

function profileLength() {
  const { chainage } = page.poses;  // rounded: the last one may lie behind the end
  const last = chainage.length > 0 ? chainage[chainage.length - 1] - profileStart() : 0;
  return Math.max(page.facts.inputs.trajectory.length, last, 1e-3);
}

/** The chainage of the first pose. */
function profileStart() {
  return page.facts.inputs.trajectory.chainage_start;
}

/** Where a stretch of the profile may begin. */
function stretchStart(from, span) {
  return profileStart() + clamp(from - profileStart(), 0, profileLength() - span);
}

/**
 * The line of the profile as pieces: for each pixel column the least and the greatest. Poses where
 * nothing was found leave a gap.
 */
function profileLine() {
  const { chainage } = page.poses, n = page.poses.count, bins = new Map();
  for (let i = 0; i < n; ++i) {
    if (chainage[i] < profile.from || chainage[i] > profile.to) continue;
    const d = distanceAt(i), x = Math.round(profileX(chainage[i]) * 2) / 2;
    const bin = bins.get(x);
    if (d === null) { if (!bin) bins.set(x, null); }
    else if (bin) { bin[0] = Math.min(bin[0], d); bin[1] = Math.max(bin[1], d); bin[2] = d; }
    else bins.set(x, [d, d, d]);
  }
  const pieces = [];
  let piece = null;
  for (const [x, bin] of bins) {
    if (!bin) { piece = null; continue; }
    if (!piece) pieces.push(piece = []);
    const [lo, hi, last] = bin;
    piece.push([x, hi]);
    if (lo < hi) piece.push([x, lo], [x, last]);
  }
  return pieces;
}

/** Round stations of the shown part of the path, each as [chainage, station]. */
function stationTicks(most) {
  const { chainage, labels: { station: stations } } = page.poses;
  const [from, to] = [profile.from, profile.to].map(stationAt);
  if (from === null || from === to) return [];
  const out = [];
  for (const value of ticks(Math.min(from, to), Math.max(from, to), most)) {
    for (let i = 0; i + 1 < chainage.length; ++i) {
      const [a, b] = [stations[i] - value, stations[i + 1] - value];
      if (a === b || a * b > 0) continue;
      const c = chainage[i] + a / (a - b) * (chainage[i + 1] - chainage[i]);
      if (c < profile.from || c > profile.to) continue;
      out.push([c, value]);
      break;
    }
  }
  return out;
}

function profileAxes() {
  const { left, top, tall, wide, width } = profile, right = left + wide, out = profile.axes(6);
  for (const [c, value] of stationTicks(width / 90).filter(([at]) => profileX(at) > left + 20)) {
    out.push(make("line", { x1: profileX(c), x2: profileX(c), y1: top, y2: top + 5, class: "tick" }),
             make("text", { x: profileX(c), y: top + 16, class: "middle station" }, minus(value)));
  }
  if (page.poses.labels.station) out.push(make("text", { x: right, y: top - 8, class: "end station" }, "station (m)"));
  out.push(make("text", { x: 14, y: top + tall / 2, class: "middle", transform: `rotate(-90 14 ${top + tall / 2})` },
                `least distance (${unitSymbol})`));
  return out;
}

function profileCurve() {
  if (!page.poses.distance || page.poses.count === 0) return [];
  const radius = page.facts.query.radius, pieces = profileLine();
  const line = pieces.map((points) => points.map(([x, d], i) =>
      `${i ? "L" : "M"}${x} ${profileY(d).toFixed(1)}`).join("") + "h0").join("");
  const area = pieces.map((points) => `M${points[0][0]} ${profileY(radius)}` +
      points.map(([x, d]) => `L${x} ${profileY(Math.min(d, radius)).toFixed(1)}`).join("") +
      `L${points.at(-1)[0]} ${profileY(radius)}Z`).join("");
  return [make("path", { d: area, fill: "url(#hatch)", stroke: "none" }),
          make("path", { d: line, class: "curve" })];
}

const kSideLines = { left: "5 3", right: "1.5 2.5", above: "9 3 2 3" };

/** For left, right and above, the least clearance of each stretch as a line over it; a gap where none is known. */
function profileSides() {
  const list = page.facts.stations?.list ?? [], out = [];
  for (const [side, dash] of Object.entries(kSideLines)) {
    const known = list.filter((r) => r[side] !== null && r.chainage_to >= profile.from && r.chainage_from <= profile.to);
    if (known.length === 0) continue;
    const line = known.map((r) => {
      const [x1, x2] = [r.chainage_from, r.chainage_to].map((c) => profile.inside(c).toFixed(1));
      return `M${x1} ${profileY(r[side]).toFixed(1)}H${x2}`;
    }).join("");
    out.push(make("path", { d: line, class: `side ${side}`, fill: "none", stroke: "#3b4450", "stroke-width": 2.2,
                            "stroke-dasharray": dash }, make("title", {}, `least clearance ${side}, by stretch`)));
  }
  return out;
}

/** Which line of the profile is which. */
function profileKeys() {
  const list = page.facts.stations?.list ?? [];
  const sides = Object.keys(kSideLines).filter((side) => list.some((r) => r[side] !== null));
  if (sides.length === 0) return "";
  const sample = (dash) => make("svg", { width: 34, height: 10, style: "display:inline;width:34px;height:10px", "aria-hidden": "true" },
      make("line", { x1: 1, x2: 33, y1: 5, y2: 5, stroke: "#3b4450", "stroke-width": 1.6, "stroke-dasharray": dash }));
  return make("ul", { class: "legend", id: "profile-keys", style: "display:flex;flex-wrap:wrap;gap:0 1.5em" }, sides.map((side) =>
      make("li", {}, sample(kSideLines[side]), ` least clearance ${side}, by stretch`)));
}

/** What a gap of the curve means where the vehicle was searched. */
function profileBeyond() {
  const { no_distance: none } = page.facts.page;
  if (!page.poses.distance || !page.poses.distance.some((d, i) => d === none && isSearched(i))) return [];
  const far = shortLength(page.facts.query.profile);
  const shaded = silentStretches().length > 0 ? " and no shading" : "";
  return make("text", { x: profile.left, y: profile.top - 8 },
              `Where there is no curve${shaded}, nothing${scannedOnly()} is closer than ${far}.`);
}

/** Conflicts as bars below the axis. */
function profileConflicts() {
  const several = classesDiffer(), worst = worstConflict();
  return profile.bars(conflictList().map((conflict) => {
    const words = classOf(conflict.least_distance), quiet = isAccepted(conflict), colour = quiet ? kQuietColour : words.colour;
    return { from: conflict.chainage_from, to: conflict.chainage_to, chosen: conflict === page.conflict,
             label: `${several ? words.symbol : ""}${conflict.id}${quiet ? "✓" : ""}`, choose: () => selectConflict(conflict),
             title: `Conflict ${conflict.id}${conflict === worst ? " (worst)" : ""}${after(conflict.class)}${after(ledgerStatus(conflict))}`,
             look: (x, y, width) => isPossible(conflict)
                 ? { x: x + 1, y: y + 1, width: Math.max(2, width - 2), height: 5, fill: "#fff", stroke: colour, "stroke-width": quiet ? 1 : 2 }
                 : quiet ? { x, y: y + 2, width, height: 3, fill: colour } : { x, y, width, height: 7, fill: colour } };
  }));
}

/** Words on the profile, beside a line at its left end or, with "end ", at its right one. */
const profileWords = (y, text, end = "") => make("text",
    { x: end ? profile.left + profile.wide - 4 : profile.left + 6, y, class: `${end}strong halo` }, text);

/** Between its borders an error budget leaves it open whether something is too close. */
function profileMargins() {
  const { query, margins } = page.facts;
  if (!margins) return [];
  const far = query.radius + margins.clear, close = query.radius - margins.conflict, sure = close > profile.low;
  const y1 = profileY(far), y2 = profileY(Math.max(close, profile.low));
  return [make("rect", { ...profile.field, y: y1, height: y2 - y1, class: "margins" }),
          profile.level(far, "margin"), sure && profile.level(close, "margin"),
          profileWords(y1 - 5, `clear above ${shortLength(+far.toPrecision(4))}`),
          profileWords(sure ? y2 + 15 : y2 - 6, sure ? `certainly too close below ${shortLength(+close.toPrecision(4))}`
              : "no distance is certainly too close, because the errors exceed the margin")];
}

function profileRequired() {
  const { radius } = page.facts.query;
  return [profile.level(radius, "required"), profileWords(profileY(radius) - 5, `required ${shortLength(radius)}`, "end ")];
}

/** Below it the environment is inside the vehicle. */
const profileSurface = () => profile.low === 0 ? []
    : [profile.level(0, "surface"), profileWords(profileY(0) + 16, "inside the vehicle")];

function drawProfile() {
  const holder = byId("profile-chart"), { query } = page.facts;
  profile.width = profile.onPaper ? 720 : Math.max(520, holder.clientWidth || 1000);
  profile.height = profile.onPaper ? 360 : clamp(profile.width * 0.24, 220, 420);
  profile.low = profileLow();
  profile.high = profileTop();
  profile.bottom = conflictList().length > 0 ? 68 : 42;
  const { left, width, height, top, base } = profile, [margins, ...borders] = profileMargins();
  const none = !(query.profile > 0) && make("text", { x: (left + width) / 2, y: height / 2 - 30, class: "middle strong halo" },
      query.between_poses ? "A run between poses has no profile."
          : "The result has no profile: clearway run --profile D adds this curve.");
  watchProfile(profile.show(holder, profileLabel(), [
    make("defs", {}, hatching("hatch", 7, 45, "#fbd9c6", ["#c2410c", 2.5]), unsearchedPatterns(), notScannedPattern()),
    make("rect", { ...profile.field, class: "field" }),
    profileAxes(), margins, profileUnsearched(), profileNotScanned(), profileSides(), profileCurve(),
    profileSurface(), borders, profileRequired(), profileBeyond(), profileConflicts(),
    make("line", { id: "profile-cursor", class: "cursor", y1: top, y2: base }), none], profileKeys()));
  moveProfileCursor();
}

function profileLabel() {
  return `Least distance against chainage, required ${shortLength(page.facts.query.radius)}. ` +
      "Arrow keys go from pose to pose, plus and minus zoom, 0 shows all.";
}

function zoomProfile(factor, at) {
  const all = profileLength(), span = clamp((profile.to - profile.from) * factor, all / 5000, all);
  const centre = at ?? page.poses.chainage[page.pose] ?? profileStart() + all / 2;
  const share = clamp((centre - profile.from) / (profile.to - profile.from), 0, 1);
  showProfileFrom(centre - share * span, span);
}

/** Shows a stretch of that length, as far as the path goes. */
function showProfileFrom(from, span = profile.to - profile.from) {
  profile.from = stretchStart(from, span);
  profile.to = profile.from + span;
  drawProfile();
}

const chainageAt = (svg, event) => profile.at(svg, event)[0];

function watchProfile(svg) {
  svg.addEventListener("pointermove", (event) => {
    const chainage = stretchStart(chainageAt(svg, event), 0);
    if (event.buttons & 1) {
      showProfileFrom(profile.from + (profile.grip ?? chainage) - chainage);
    } else if (page.poses.count > 0) {
      showProfileValue(poseAtChainage(chainage));
    }
  });
  svg.addEventListener("pointerdown", (event) => { profile.grip = chainageAt(svg, event); });
  svg.addEventListener("pointerleave", () => showProfileValue(page.pose));
  svg.addEventListener("click", (event) => selectPose(poseAtChainage(chainageAt(svg, event))));
  svg.addEventListener("dblclick", () => zoomProfile(1e9));
  svg.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && document.activeElement !== svg) return;  // the page scrolls
    event.preventDefault();
    zoomProfile(event.deltaY > 0 ? 1.25 : 0.8, chainageAt(svg, event));
  }, { passive: false });
  onKeys(svg, ({ shiftKey }) => {
    const far = shiftKey ? 50 : 1;
    return {
      ArrowRight: () => selectPose(page.pose + far), ArrowLeft: () => selectPose(page.pose - far),
      Home: () => selectPose(0), End: () => selectPose(page.poses.count - 1),
      ...zoomKeys(() => zoomProfile(0.5), () => zoomProfile(2), () => zoomProfile(1e9)),
    };
  });
}

function profileValueWords(i) {
  const left = unsearchedWords(i);
  return distanceWords(i) + (left ? `${isSearched(i) && distanceWords(i) ? ", " : ": "}${left}` : "");
}

function distanceWords(i) {
  const d = distanceAt(i), { query } = page.facts;
  if (d === undefined || !isSearched(i)) return "";
  if (d === null) return `: beyond ${shortLength(query.profile)}, nothing is closer`;
  const missing = query.radius - d;
  const distance = isInside(d) ? `${depthWords(d)} inside the vehicle` : metres(d);
  return `: ${distance}` + (missing > 0 ? `, ${missingClause(missingWords(missing, d, isAllSolid() ? "exact" : "at-least"))}` : ", enough");
}

function showProfileValue(i) {
  if (page.poses.count === 0) return;
  let text = poseLabel(i) + profileValueWords(i);
  const d = distanceAt(i);
  if (d !== undefined && d !== null) {
    const step = page.facts.page.lattice.step, { px, py, pz } = page.poses;
    const point = coordinates(inScan([px[i] * step, py[i] * step, pz[i] * step]));
    text += `. ${isInside(d) ? "Deepest" : "Nearest"} point: ${point}`;
  }
  byId("profile-readout").textContent = text[0].toUpperCase() + text.slice(1);
  placeProfileCursor(i);
}

function placeProfileCursor(i) {
  const line = byId("profile-cursor"), chainage = page.poses.chainage[i];
  if (!line) return;
  const inside = chainage >= profile.from && chainage <= profile.to;
  line.setAttribute("visibility", inside ? "visible" : "hidden");
  line.setAttribute("x1", profileX(chainage));
  line.setAttribute("x2", profileX(chainage));
}

/** The chosen pose stays in sight. */
function moveProfileCursor() {
  if (page.poses.count === 0) return;
  const chainage = page.poses.chainage[page.pose];
  if (chainage < profile.from || chainage > profile.to) showProfileFrom(chainage - (profile.to - profile.from) / 2);
  else showProfileValue(page.pose);
}

/** The pose of the least distance, seen from near where all of the path is shown. */
function goToNearest() {
  selectPose(shownPose(page.facts.least_distance.pose));
  if (profile.to - profile.from > 0.99 * profileLength()) zoomProfile(0.2);
  showProfileValue(page.pose);
  notify("overview");
}

function buildProfile() {
  profile.from = profileStart();
  profile.to = profileStart() + profileLength();
  const { least_distance: least } = page.facts;
  byId("profile-tools").append(
    button("Zoom in", () => zoomProfile(0.5)), button("Zoom out", () => zoomProfile(2)),
    button("All", () => zoomProfile(1e9)),
    least ? button(isInside(least.distance) ? "Deepest pose" : "Nearest pose", goToNearest) : "",
    make("span", { class: "hint" }, "Drag moves, Ctrl and wheel zoom, arrow keys step."));
  drawProfile();
  byId("profile-unsearched").append(...unsearchedLegend(), ...notScannedLegend());
  on("pose", moveProfileCursor);
  on("conflict", drawProfile);
  new ResizeObserver(() => {
    if (!profile.onPaper && Math.abs(byId("profile-chart").clientWidth - profile.width) > 8) drawProfile();
  }).observe(byId("profile-chart"));
}
