// What plan and 3-D view share: pointers, numbers to click, and the note on the environment.

/** Drags call pan(dx, dy) in parts of the canvas, wheels zoom(factor, [u, v]), clicks pick(x, y). */
function watchPointer(canvas, pan, zoom, pick) {
  let last = null, moved_far = false;
  const touches = new Map();
  canvas.addEventListener("pointerdown", (event) => {
    touches.set(event.pointerId, [event.clientX, event.clientY]);
    canvas.setPointerCapture(event.pointerId);
    last = [event.clientX, event.clientY];
    moved_far = false;
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!touches.has(event.pointerId)) return;
    const before = spread(touches);
    touches.set(event.pointerId, [event.clientX, event.clientY]);
    if (touches.size === 2) {
      zoom(before / Math.max(1, spread(touches)));
      moved_far = true;
      return;
    }
    const dx = event.clientX - last[0], dy = event.clientY - last[1];
    if (!moved_far && Math.hypot(dx, dy) < 4) return;
    moved_far = true;
    last = [event.clientX, event.clientY];
    pan(dx / canvas.clientWidth, dy / canvas.clientHeight, event);
  });
  const release = (event) => {
    if (touches.delete(event.pointerId) && event.type === "pointerup" && !moved_far) {
      const box = canvas.getBoundingClientRect();
      pick(event.clientX - box.left, event.clientY - box.top);
    }
  };
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("pointercancel", release);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && document.activeElement !== canvas) return;  // the page scrolls
    event.preventDefault();
    const box = canvas.getBoundingClientRect();
    zoom(event.deltaY > 0 ? 1.2 : 1 / 1.2, [(event.clientX - box.left) / box.width,
                                            (event.clientY - box.top) / box.height]);
  }, { passive: false });
}

/** Gives the canvases of a stage its width and this height. */
function sizeCanvases(stage, height) {
  const scale = Math.min(2, devicePixelRatio || 1);
  for (const canvas of stage.querySelectorAll("canvas")) {
    canvas.style.height = `${height}px`;
    canvas.width = Math.round(stage.clientWidth * scale);
    canvas.height = Math.round(height * scale);
  }
}

function spread(touches) {
  if (touches.size < 2) return 1;
  const [a, b] = [...touches.values()];
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
}

/** Selects what has its number there, in pixels of the page. */
function pickNumber(places, canvas, x, y) {
  const scale = canvas.width / canvas.clientWidth;
  const near = (p) => Math.hypot(p.x - x * scale, p.y - y * scale);
  const hit = places.filter((p) => near(p) < 14 * scale).sort((a, b) => near(a) - near(b));
  if (hit.length > 0) hit[0].mark.select();
  return hit.length > 0;
}

/** What is on the page of the environment, and what was left out. */
function environmentNote() {
  const { page: shown, inputs, classes } = page.facts;
  const near = `${shortLength(+shown.reach.toPrecision(2))} of the middle of the vehicle`;
  if (shown.environment_points === 0) return `No environment point is within ${near}.`;
  let text = `${count(shown.environment_points)} of ${count(inputs.environment.points)} environment ` +
      `points are drawn: `;
  text += shown.environment_spacing > 0
      ? `those within ${near} (${count(shown.environment_near)}), thinned to about one in ` +
        `${shortLength(+shown.environment_spacing.toPrecision(2))} squared, fewer far from the path.`
      : `all within ${near}.`;
  const all = classes.reduce((sum, c) => sum + c.points, 0);
  const drawn = classes.reduce((sum, c) => sum + c.shown, 0);
  text += drawn === all ? " All points of the classes are drawn."
      : ` Of ${count(all)} points of the classes ${count(drawn)} are drawn, thinned evenly.`;
  return text;
}
