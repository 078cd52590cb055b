// Buttons, keys, pointer and slider of the 3-D view.

function turnView(dx, dy, event) {
  const { right, up } = viewCamera();
  view.flight = null;
  if (event && (event.shiftKey || event.buttons & 6)) {
    const size = 2 * view.distance * Math.tan(kHalfAngle);
    view.target = plus(plus(view.target, right, -dx * size * 1.6), up, dy * size);
    view.follow = false;
    byId("view-follow").checked = false;
  } else {
    view.yaw -= 4 * dx;
    view.pitch = clamp(view.pitch + 3 * dy, -1.5, 1.55);
  }
  scheduleView();
}

function zoomView(factor) {
  view.flight = null;
  view.distance = clamp(view.distance * factor, 0.2, 1e4);
  scheduleView();
}

function viewKeys({ shiftKey }) {
  const turn = (dx, dy) => () => turnView(dx, dy, shiftKey ? { shiftKey } : undefined);
  return { ArrowLeft: turn(-0.03, 0), ArrowRight: turn(0.03, 0), ArrowUp: turn(0, -0.03), ArrowDown: turn(0, 0.03),
           ...zoomKeys(() => zoomView(0.8), () => zoomView(1.25), flyToOverview) };
}

function check(label, id, value, change) {
  const box = make("input", { type: "checkbox", id, checked: value,
                              onchange: (event) => { change(event.target.checked); scheduleView(); } });
  return make("label", {}, box, ` ${label}`);
}

function classChecks() {
  return page.facts.classes.map((c, k) => check(`${kClassWords[c.name].symbol} ${c.name}`,
      `view-class-${c.name}`, true, (shown) => {
        view.hidden = shown ? view.hidden & ~(1 << k) : view.hidden | 1 << k;
      }));
}

/** Moves the vehicle along its path in some twelve seconds. */
function playPath() {
  const play = byId("view-play"), going = play.textContent === "Stop";
  play.textContent = going ? "Drive" : "Stop";
  if (going) return;
  if (page.pose >= page.poses.count - 1) selectPose(0);
  const start = performance.now(), first = page.pose, { chainage } = page.poses;
  const speed = profileLength() / 12000;
  const step = (now) => {
    if (play.textContent !== "Stop") return;
    selectPose(Math.max(first, poseAtChainage(chainage[first] + (now - start) * speed)));
    if (page.pose >= page.poses.count - 1) play.textContent = "Drive"; else requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
}

function buildSlider() {
  const last = Math.max(0, page.poses.count - 1);
  const slider = make("input", { type: "range", id: "pose-slider", min: 0, max: last, value: 0,
                                 "aria-label": "Vehicle along its path",
                                 oninput: (event) => selectPose(+event.target.value) });
  const text = make("output", { id: "pose-text", for: "pose-slider" });
  const update = () => {
    slider.value = page.pose;
    text.textContent = page.poses.count > 0 ? poseLabel(page.pose) + profileValueWords(page.pose)
                                            : "The trajectory has no poses.";
    slider.setAttribute("aria-valuetext", text.textContent);
  };
  byId("view-slider").append(button("Drive", playPath, { id: "view-play" }), slider, text);
  on("pose", update);
  update();
}

function viewNote() {
  const { page: shown, inputs } = page.facts;
  let text = "";
  if (shown.poses < inputs.trajectory.poses) {
    text += `The slider has ${count(shown.poses)} of ${count(inputs.trajectory.poses)} poses: the ` +
        `${page.poses.distance ? "nearest" : "first"} of each stretch, and those of the conflicts. `;
  }
  if (shown.model_points < inputs.model.points) {
    text += `${count(shown.model_points)} of ${count(inputs.model.points)} points of the vehicle are drawn. `;
  }
  if (!view.scene) {
    text += "This browser has no WebGL2, so the view is drawn without it, and slowly. ";
  }
  if (silentStretches().length > 0) text += "Where the vehicle has no pose, none is drawn. ";
  if (page.unseen && page.unseen.count < seenFacts().listed_cubes) {
    text += `${count(page.unseen.count)} of ${count(seenFacts().listed_cubes)} unseen cubes are drawn. `;
  }
  return text + environmentNote() + marksNote();
}

function buildView() {
  const canvas = make("canvas", { id: "view-canvas", "aria-hidden": "true" });
  const over = make("canvas", { id: "view-numbers", tabindex: 0, role: "application", "aria-label":
      "3-D view. Arrow keys turn it, with Shift they move it, plus and minus zoom, 0 shows all." });
  byId("view-stage").append(canvas, over);
  try {
    view.scene = new WebglScene(canvas);
  } catch (error) {
    view.scene = null;  // the painter draws it
  }
  view.cutAbove = view.cutFront = page.enclosed;
  byId("view-tools").append(
    button("Overview", flyToOverview), button("Vehicle", flyToVehicle),
    button("Zoom in", () => zoomView(0.7)), button("Zoom out", () => zoomView(1 / 0.7)),
    check("follow the vehicle", "view-follow", false, (value) => { view.follow = value; }),
    check("cut off above the vehicle", "view-cut-above", view.cutAbove,
          (value) => { view.cutAbove = value; }),
    check("cut off towards you", "view-cut-front", view.cutFront,
          (value) => { view.cutFront = value; }),
    ...classChecks(), page.unseen ? check("▣ not scanned", "view-unseen", true,
                                          (shown) => { view.unseenHidden = !shown; }) : "");
  buildSlider();
  byId("view-note").append(
    make("span", { class: "hint" },
         "Drag turns, right button or Shift and drag moves, Ctrl and wheel zoom, arrow keys turn. "),
    viewNote());
  watchPointer(over, turnView, (factor) => zoomView(factor),
               (x, y) => pickNumber(view.places, over, x, y));
  onKeys(over, viewKeys);
  canvas.addEventListener("webglcontextlost", () => { byId("view-note").textContent =
      "The browser gave up the 3-D view. Load the page again to see it."; });
  sizeView();
  on("pose", scheduleView);
  on("conflict", flyToConflict);
  on("group", flyToGroup);
  on("overview", flyToVehicle);
  flyToOverview();
  new ResizeObserver(sizeView).observe(byId("view-stage"));
}
