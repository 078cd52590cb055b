/** Places along the path and the size of the vehicle, which several parts of the page need. */
function measure() {
  page.path = [];
  for (let i = 0; i < page.poses.count; ++i) page.path.push(page.bodyPoses ? poseAt(i).t : vehicleAt(i).middle);
  page.enclosed = isEnclosed();
  page.vehicleSize = sizeOfVehicle();
}

/** The section of the route, with its answer as a sentence. */
function buildRoute() {
  if (section.facts) {
    byId("section-caution").before(make("p", { id: "section-sentence" }, asSentence(section.facts.sentence)));
  }
  buildSection();
}

/** Begins with the place that matters most. */
function showFirst() {
  const least = page.facts.least_distance;
  if (worstConflict()) selectConflict(worstOutside() ?? worstConflict());
  else if (unseenGroups().length > 0) selectPose(shownPose(unseenGroups()[0].first_pose));
  else if (least) selectPose(shownPose(least.pose));
  // Of a long path the overview shows little.
  if (worstConflict() && profileLength() < 30 * page.vehicleSize) flyToOverview();
}

startPage(() => Promise.all([readAll(), readSection()]),
          [measure, buildVerdict, buildProfile, buildPlan, buildTable, buildDetails, buildLedgerRows, buildUnseen, buildStations, buildRoute,
           buildView, buildPrint, showFirst]);
