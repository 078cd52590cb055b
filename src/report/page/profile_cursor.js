// Where the vehicle is on the profile, and what the profile says there.

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
  const chainage = page.poses.chainage[page.pose], span = profile.to - profile.from;
  if (chainage < profile.from || chainage > profile.to) {
    profile.from = stretchStart(chainage - span / 2, span);
    profile.to = profile.from + span;
    drawProfile();
    return;
  }
  showProfileValue(page.pose);
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
