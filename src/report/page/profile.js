// The least distance of every pose against chainage, with the required distance and the conflicts.

const profile = { from: 0, to: 1, low: 0, width: 1000, height: 300, left: 62, right: 16, top: 26, bottom: 68,
                  onPaper: false };

function profileX(chainage) {
  const inner = profile.width - profile.left - profile.right;
  return profile.left + inner * (chainage - profile.from) / (profile.to - profile.from);
}

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

function profileY(distance) {
  const inner = profile.height - profile.top - profile.bottom, top = profileTop();
  return profile.top + inner * (top - Math.min(distance, top)) / (top - profile.low);
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
  const { width, height, left, right, bottom, top } = profile, out = [];
  for (const d of ticks(profile.low, profileTop(), 6)) {
    out.push(make("line", { x1: left, x2: width - right, y1: profileY(d), y2: profileY(d),
                            class: "grid" }),
             make("text", { x: left - 6, y: profileY(d) + 4, class: "end" },
                  String(d).replace("-", "−")));
  }
  const wide = width / 90;
  for (const c of ticks(profile.from, profile.to, wide)) {
    out.push(make("line", { x1: profileX(c), x2: profileX(c), y1: top, y2: height - bottom,
                            class: "grid" }),
             make("text", { x: profileX(c), y: height - bottom + 16, class: "middle" }, String(c)));
  }
  for (const [c, value] of stationTicks(wide).filter(([at]) => profileX(at) > left + 20)) {
    out.push(make("line", { x1: profileX(c), x2: profileX(c), y1: top, y2: top + 5, stroke: "#6b7280" }),
             make("text", { x: profileX(c), y: top + 16, class: "middle station" }, String(value).replace("-", "−")));
  }
  if (page.poses.labels.station) {
    out.push(make("text", { x: width - right, y: top - 8, class: "end station" }, "station (m)"));
  }
  out.push(make("text", { x: width - right, y: height - 4, class: "end" },
                `chainage (${unitSymbol})`),
           make("text", { x: 14, y: (top + height - bottom) / 2, class: "middle",
                          transform: `rotate(-90 14 ${(top + height - bottom) / 2})` },
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
      const [x1, x2] = [r.chainage_from, r.chainage_to].map((c) =>
          clamp(profileX(c), profile.left, profile.width - profile.right).toFixed(1));
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

/** Conflicts as bars below the axis, numbered where there is room. */
function profileConflicts() {
  const out = [], y = profile.height - profile.bottom + 24;
  let free = -Infinity;
  profile.crowded = 0;
  const worst = worstConflict(), several = classesDiffer();
  const ends = (conflict) => [conflict.chainage_from, conflict.chainage_to].map((c) =>
      clamp(profileX(c), profile.left, profile.width - profile.right));
  const middleOf = (conflict) => ends(conflict)[0] + Math.max(3, ends(conflict)[1] - ends(conflict)[0]) / 2;
  const taken = page.conflict ? middleOf(page.conflict) : -Infinity;
  for (const conflict of conflictList()) {
    if (conflict.chainage_to < profile.from || conflict.chainage_from > profile.to) continue;
    const [x1, x2] = ends(conflict);
    const chosen = conflict === page.conflict, words = classOf(conflict.least_distance), quiet = isAccepted(conflict);
    const colour = quiet ? kQuietColour : words.colour;
    const width = Math.max(3, x2 - x1), middle = middleOf(conflict);
    const marked = `${several ? words.symbol : ""}${conflict.id}${quiet ? "✓" : ""}`;
    const room = 8 * marked.length + 10;
    const label = chosen || (middle - free > room && Math.abs(middle - taken) > room);
    if (label) free = middle; else ++profile.crowded;
    const extra = conflict === worst ? " (worst)" : "";
    out.push(make("g", { class: chosen ? "mark chosen" : "mark",
                         onclick: (event) => { event.stopPropagation(); selectConflict(conflict); } },
      make("rect", isPossible(conflict)
          ? { x: x1 + 1, y: y + 1, width: Math.max(2, width - 2), height: 5, fill: "#fff",
              stroke: colour, "stroke-width": quiet ? 1 : 2 }
          : quiet ? { x: x1, y: y + 2, width, height: 3, fill: colour } : { x: x1, y, width, height: 7, fill: colour }),
      label && make("text", { x: middle, y: y + 21, class: "middle" }, marked),
      make("title", {}, `Conflict ${conflict.id}${extra}` + (conflict.class ? `, ${conflict.class}` : "") +
                           after(ledgerStatus(conflict)))));
  }
  return out;
}

/** Between its borders an error budget leaves it open whether something is too close. */
function profileMargins() {
  const { query, margins } = page.facts, { left, width, right } = profile;
  if (!margins) return [];
  const far = query.radius + margins.clear, close = query.radius - margins.conflict;
  const y1 = profileY(far), y2 = profileY(Math.max(close, profile.low)), x2 = width - right;
  const line = (y) => make("line", { x1: left, x2, y1: y, y2: y, class: "margin" });
  const words = (y, text) => make("text", { x: left + 6, y, class: "strong halo" }, text);
  const sure = close > profile.low;
  return [make("rect", { x: left, y: y1, width: x2 - left, height: y2 - y1, class: "margins" }),
          line(y1), sure && line(y2),
          words(y1 - 5, `clear above ${shortLength(+far.toPrecision(4))}`),
          words(sure ? y2 + 15 : y2 - 6, sure ? `certainly too close below ${shortLength(+close.toPrecision(4))}`
              : "no distance is certainly too close, because the errors exceed the margin")].filter(Boolean);
}

function profileRequired() {
  const y = profileY(page.facts.query.radius), { left, width, right } = profile;
  return [make("line", { x1: left, x2: width - right, y1: y, y2: y, class: "required" }),
          make("text", { x: width - right - 4, y: y - 5, class: "end strong halo" },
               `required ${shortLength(page.facts.query.radius)}`)];
}

/** Below it the environment is inside the vehicle. */
function profileSurface() {
  if (profile.low === 0) return [];
  const y = profileY(0), { left, width, right } = profile;
  return [make("line", { x1: left, x2: width - right, y1: y, y2: y, class: "surface" }),
          make("text", { x: left + 6, y: y + 16, class: "strong halo" },
               "inside the vehicle")];
}

function drawProfile() {
  const holder = byId("profile-chart"), { query } = page.facts;
  profile.width = profile.onPaper ? 720 : Math.max(520, holder.clientWidth || 1000);
  profile.height = profile.onPaper ? 360 : clamp(profile.width * 0.24, 220, 420);
  profile.low = profileLow();
  profile.bottom = conflictList().length > 0 ? 68 : 42;
  const { width, height, left, right, top, bottom } = profile;
  const hatch = make("pattern", { id: "hatch", width: 7, height: 7, patternUnits: "userSpaceOnUse",
                                  patternTransform: "rotate(45)" },
                     make("rect", { width: 7, height: 7, fill: "#fbd9c6" }),
                     make("line", { x1: 0, y1: 0, x2: 0, y2: 7, stroke: "#c2410c",
                                    "stroke-width": 2.5 }));
  const svg = make("svg", { viewBox: `0 0 ${width} ${height}`, width, height, tabindex: 0,
                            role: "application", "aria-label": profileLabel() },
    make("defs", {}, hatch, unsearchedPatterns(), notScannedPattern()),
    make("rect", { x: left, y: top, width: width - left - right, height: height - top - bottom,
                   class: "field" }),
    profileAxes(), profileMargins().slice(0, 1), profileUnsearched(), profileNotScanned(), profileSides(), profileCurve(),
    profileSurface(), profileMargins().slice(1), profileRequired(), profileBeyond(), profileConflicts(),
    make("line", { id: "profile-cursor", class: "cursor", y1: top, y2: height - bottom }));
  if (!(query.profile > 0)) {
    svg.append(make("text", { x: (left + width) / 2, y: height / 2 - 30, class: "middle strong halo" },
                    query.between_poses ? "A run between poses has no profile."
                        : "The result has no profile: clearway run --profile D adds this curve."));
  }
  const focused = holder.contains(document.activeElement);
  holder.replaceChildren(svg, profileKeys(), crowdedBars(profile.crowded));
  watchProfile(svg);
  if (focused) svg.focus();
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
  profile.from = stretchStart(centre - share * span, span);
  profile.to = profile.from + span;
  drawProfile();
}

function panProfile(metresAlong) {
  const span = profile.to - profile.from;
  profile.from = stretchStart(profile.from + metresAlong, span);
  profile.to = profile.from + span;
  drawProfile();
}

function chainageAt(svg, event) {
  const box = svg.getBoundingClientRect();
  const x = (event.clientX - box.left) * profile.width / box.width;
  const inner = profile.width - profile.left - profile.right;
  return profile.from + (x - profile.left) / inner * (profile.to - profile.from);
}

function watchProfile(svg) {
  svg.addEventListener("pointermove", (event) => {
    const chainage = stretchStart(chainageAt(svg, event), 0);
    if (event.buttons & 1) {
      panProfile((profile.grip ?? chainage) - chainage);
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
  svg.addEventListener("keydown", profileKey);
}

function profileKey(event) {
  const far = event.shiftKey ? 50 : 1;
  const actions = {
    ArrowRight: () => selectPose(page.pose + far), ArrowLeft: () => selectPose(page.pose - far),
    Home: () => selectPose(0), End: () => selectPose(page.poses.count - 1),
    "+": () => zoomProfile(0.5), "=": () => zoomProfile(0.5), "-": () => zoomProfile(2),
    "0": () => zoomProfile(1e9),
  };
  if (!actions[event.key]) return;
  event.preventDefault();
  actions[event.key]();
}
