// What is written on the pictures.

function haloText(context, text, x, y, align = "left") {
  context.textAlign = align;
  context.lineJoin = "round";
  context.lineWidth = 4 * context.canvas.width / 480;
  context.strokeStyle = "rgba(255,255,255,0.9)";
  context.strokeText(text, x, y);
  context.fillText(text, x, y);
}

function setFont(context, pixels, weight = "") {
  context.font = `${weight} ${pixels}px system-ui, "DejaVu Sans", Arial, sans-serif`;
}

/** A line through those of the places that are in front of the eye. */
function strokeThrough(context, places, style, width) {
  Object.assign(context, { strokeStyle: style, lineWidth: width, lineJoin: "round" });
  context.beginPath();
  for (const place of places) if (place) context.lineTo(place[0], place[1]);
  context.stroke();
}

/** A length of 1, 2 or 5 times a power of ten, at most `most`. */
function roundLength(most) {
  const power = 10 ** Math.floor(Math.log10(most));
  return [5, 2, 1].map((f) => f * power).find((v) => v <= most) ?? power;
}

function drawScaleBar(context, perMetre, unitSize) {
  const { width, height } = context.canvas, bar = roundLength(0.25 * width / perMetre);
  const x = 10 * unitSize, y = height - 10 * unitSize, w = bar * perMetre;
  context.fillStyle = "#111827";
  context.fillRect(x, y - 2 * unitSize, w, 2.5 * unitSize);
  context.fillRect(x, y - 7 * unitSize, 1.5 * unitSize, 7 * unitSize);
  context.fillRect(x + w - 1.5 * unitSize, y - 7 * unitSize, 1.5 * unitSize, 7 * unitSize);
  setFont(context, 12 * unitSize);
  haloText(context, shortLength(bar), x + w + 6 * unitSize, y + unitSize);
}

/** The line of the least distance, with its length. */
function drawDistance(context, painter, conflict, vehicle, unitSize) {
  const place = placeOf(conflict), near = nearestOfModel(vehicle.shown, place);
  const a = painter.project(place), b = painter.project(near.point);
  const distance = conflict.least_distance, inside = isInside(distance);
  // A wall of another part may be nearer to what lies inside.
  if (!inside || near.distance > -0.9 * distance) {
    strokeThrough(context, [a, b], "#111827", 1.6 * unitSize);
  }
  drawRing(context, a, unitSize);
  context.fillStyle = "#111827";
  setFont(context, 14 * unitSize, "600");
  const text = inside ? depthWords(distance)
                      : `${metres(distance)} of ${metres(page.facts.query.radius)}`;
  const right = a[0] < context.canvas.width / 2;
  haloText(context, text, a[0] + (right ? 14 : -14) * unitSize, a[1] - 14 * unitSize,
           right ? "left" : "right");
}

function drawRing(context, at, unitSize) {
  for (const [style, wide] of [["#fff", 4], ["#111827", 1.8]]) {
    context.strokeStyle = style;
    context.lineWidth = wide * unitSize;
    context.beginPath();
    context.arc(at[0], at[1], 9 * unitSize, 0, 7);
    context.stroke();
  }
}

function drawLabels(context, painter, conflict, vehicle, kind, unitSize, thickness) {
  const { width, height } = context.canvas;
  drawScaleBar(context, painter.perMetre, unitSize);
  if (kind === "section" && conflict.nearest_point) {
    drawDistance(context, painter, conflict, vehicle, unitSize);
  } else {
    drawRing(context, painter.project(placeOf(conflict)), unitSize);
  }
  context.fillStyle = "#374151";
  setFont(context, 12 * unitSize);
  if (kind === "above") {
    haloText(context, "front →", width - 8 * unitSize, height / 2, "right");
    haloText(context, "left side", width / 2, 16 * unitSize, "center");
    haloText(context, "right side", width / 2, height - 8 * unitSize, "center");
  } else {
    haloText(context, "its right", 8 * unitSize, height / 2);
    haloText(context, "its left", width - 8 * unitSize, height / 2, "right");
  }
  if (kind === "section") {
    haloText(context, `slice ${shortLength(2 * thickness)} thick`, width - 8 * unitSize,
             height - 8 * unitSize, "right");
  }
}
