async function start() {
  if (typeof DecompressionStream === "undefined") {
    throw new Error("This browser is too old for this page: it needs DecompressionStream " +
                    "(Chromium 80, Firefox 113, Safari 16.4, or later).");
  }
  await Promise.all([readAll(), readSection()]);
  page.path = [];
  for (let i = 0; i < page.poses.count; ++i) page.path.push(page.bodyPoses ? poseAt(i).t : vehicleAt(i).middle);
  page.enclosed = isEnclosed();
  page.vehicleSize = sizeOfVehicle();
  for (const build of [buildVerdict, buildProfile, buildPlan, buildTable, buildDetails, buildUnseen,
                       buildStations, buildSection, buildView, buildPrint]) {
    build();
  }
  const least = page.facts.least_distance;
  if (worstConflict()) selectConflict(worstConflict());
  else if (unseenGroups().length > 0) selectPose(shownPose(unseenGroups()[0].first_pose));
  else if (least) selectPose(shownPose(least.pose));
  // Of a long path the overview shows little.
  if (worstConflict() && profileLength() < 30 * page.vehicleSize) flyToOverview();
  document.body.dataset.ready = "true";
}

start().catch((error) => {
  const holder = byId("loading") ?? byId("verdict-body");
  holder.className = "problem";
  holder.textContent = error.message;
  document.body.dataset.ready = "failed";
  console.error(error);
});
