const unitSymbol = { metre: "m", foot: "ft", "us-survey-foot": "US ft", degree: "°" }[page.facts.unit]
    ?? "m";
const kClassWords = {
  hit: { shape: "diamond", symbol: "◆", colour: "#c2410c", rgb: [213, 70, 0] },
  near: { shape: "triangle", symbol: "▲", colour: "#a16207", rgb: [240, 170, 0] },
  watch: { shape: "round", symbol: "●", colour: "#0369a1", rgb: [0, 114, 190] },
};
const kQuietColour = "#6b7280";
const kModelColour = "#00735c", kModelRgb = [0, 140, 110];

/** Bodies next to each other differ a little. */
const bodyRgb = (body) => body % 2 === 0 ? kModelRgb : [0, 108, 132];

const count = (n) => Math.round(n).toLocaleString("en-US");
const plural = (n, one, many = one + "s") => `${count(n)} ${n === 1 ? one : many}`;
/** Digits after the point with which none of these lengths looks like nothing. */
const digitsFor = (values) => values.some((v) => v && Math.abs(v) < 0.001) ? 4 : 3;
/** A distance; what is less than half of the last digit is said to be below it. */
const fixed = (v, digits) => v > 0 && v < 0.5 * 10 ** -digits ? `< ${(10 ** -digits).toFixed(digits)}`
    : v.toFixed(digits).replace("-", "−");
/** Below 0 it is a depth inside a solid vehicle. */
const isInside = (distance) => distance !== null && distance !== undefined && distance < 0;
const depthWords = (distance) => `${metres(-distance)} deep`;
const metres = (v, digits = digitsFor([v])) => v === null || v === undefined ? "unknown"
    : `${fixed(v, digits)} ${unitSymbol}`;
/** Below it the surfaces meet, as far as scans can show; only pages of results have it. */
const kTouching = page.facts.touching;
/**
 * What is missing, with the digits of the distance, so that both add up to what is required. A
 * surface and points have no inside, so there it is at least so much. unit: left out in tables.
 */
function missingWords(missing, distance, bound, unit = ` ${unitSymbol}`) {
  if (!(missing > 0)) return "";  // the points are only near
  if (bound === "at-least" && distance < kTouching) return "touches";
  return `${bound === "at-least" ? "at least " : ""}${fixed(missing, digitsFor([distance]))}${unit}`;
}
const missingClause = (words) => words === "touches" ? "it touches the vehicle" : `${words} missing`;
const station = (v) => metres(v, 2);
/** The station along the alignment at a chainage, between those of the shown poses; null without stations. */
function stationAt(at) {
  const { chainage, labels: { station: stations } } = page.poses;
  if (!stations || stations.length === 0) return null;
  const behind = firstThat(chainage, (c) => c > at);
  if (behind === 0 || behind === chainage.length) return stations[behind === 0 ? 0 : behind - 1];
  const part = (at - chainage[behind - 1]) / (chainage[behind] - chainage[behind - 1]);
  return stations[behind - 1] + part * (stations[behind] - stations[behind - 1]);
}
/** " (station 1234.50 m)" beside a chainage, which is what a client knows a place by; or nothing. */
const besideChainage = (chainage) => stationAt(chainage) === null ? ""
    : ` (station ${fixed(stationAt(chainage), 2)} m)`;
/** A place of the path: its chainage, with the station beside it. */
const placeWords = (chainage) => station(chainage) + besideChainage(chainage);
const shortLength = (v) => `${+v.toPrecision(4)} ${unitSymbol}`;
const coordinates = (p) => p.map((v) => v.toFixed(2)).join(", ");

const kSides = { left: "left", right: "right", above: "above", below: "below", front: "in front",
                 behind: "behind", around: "around", unknown: "" };
/** Where something lies, seen from the vehicle; and from where it came in if it is inside. */
const sideWords = (side) => page.facts.side_words[side][0];
const innerSideWords = (side) => page.facts.side_words[side][1];
/** On which side something lies; of what is inside the vehicle, from which it came in. */
const sideOfPlace = ({ side, least_distance: distance }) => isInside(distance) ? innerSideWords(side) : sideWords(side);

/** Left is positive. Without "-0.00". */
function signed(v) {
  const sign = +v.toFixed(2) === 0 ? "" : v > 0 ? "+" : "−";
  return sign + Math.abs(v).toFixed(2);
}

/** Where a place is, seen from the path, or from the body; empty where that is not known. */
function offsetWords({ lateral, height, body }) {
  if (lateral === null || height === null) return "";
  const from = body === undefined ? "the path" : "its origin";
  return `${metres(Math.abs(lateral), 2)} ${lateral < 0 ? "right" : "left"} of ${from} and ` +
      `${metres(Math.abs(height), 2)} ${height < 0 ? "below" : "above"} it`;
}

/** ", text", or nothing. */
const after = (text) => text ? `, ${text}` : "";

/** ", body NAME", where there are several. */
const bodyWords = ({ body }) => body === undefined ? "" : body === "body" ? ", the body" : `, body "${body}"`;

/** Where along the path the obstacle stands. If that is not known, where it is nearest or begins. */
function stationOf(conflict) {
  if (conflict.obstacle_chainage !== null) return conflict.obstacle_chainage;
  return conflict.nearest_pose === null ? conflict.chainage_from
      : page.poses.chainage[shownPose(conflict.nearest_pose)];
}

/** The class of a distance: {name, below, ...words}; the last one for distances beyond all. */
function classOf(distance) {
  const classes = page.facts.classes, radius = page.facts.query.radius;
  const found = classes.find((c) => distance === null ? c.below >= radius : distance < c.below);
  const chosen = found ?? classes[classes.length - 1];
  return { ...chosen, ...kClassWords[chosen.name] };
}

/** What would say more, and how to get it. */
function missingParts() {
  const { query, conflicts } = page.facts, out = [];
  const distance = shortLength(+(Math.max(5 * query.radius, 0.5)).toPrecision(2)).split(" ")[0];
  if (!conflicts) {
    out.push({ what: "Places of conflicts", why: "the result has no first poses",
               how: "clearway run --first-pose" });
  }
  if (query.between_poses) {
    out.push({ what: "Distances", why: "a run between poses has none",
               how: "clearway trajectory resample, and a run of its poses" });
    return out;
  }
  if (!(query.clearance > 0)) {
    out.push({ what: "How much is missing at each place",
               why: "the result has no clearances", how: `clearway run --clearance ${distance}` });
  }
  if (!(query.profile > 0)) {
    out.push({ what: "The least distance along the path", why: "the result has no profile",
               how: `clearway run --profile ${distance}` });
  }
  return out;
}

/** of: a place with side, lateral and height. */
function nearestPointSentence({ point, ...of }, distance) {
  if (!point) return "";
  const where = [isInside(distance) ? "" : sideWords(of.side), offsetWords(of)].filter(Boolean).join(", ");
  const which = isInside(distance) ? "deepest" : "nearest";
  return ` The ${which} point is ${where}${where ? "," : ""} at ${coordinates(point)}` +
      `${of.point_class ? ` and of ${of.point_class}` : ""}.`;
}

function leastSentence() {
  const { least_distance: least, query, words } = page.facts;
  const where = least ? [isInside(least.distance) ? "" : sideWords(least.side), offsetWords(least)].filter(Boolean).join(", ") : "";
  if (words.nearest) return words.nearest + (where ? ` That point is ${where}.` : "");
  return query.between_poses
      ? "How close it comes is not known: a run between poses has no distances."
      : "How close it comes is not known: run again with --profile or --clearance.";
}

function worstConflict() {
  const found = page.facts.conflicts;
  return found && found.worst !== null ? found.list.find((c) => c.id === found.worst) : null;
}

/** A label of a pose, such as "station 12.50 m"; nothing for an empty name. */
function labelWords({ title, unit }, value) {
  if (typeof value === "string") return value && [title, value].filter(Boolean).join(" ");
  return [title, unit === "m" ? fixed(value, 2) : value.toFixed(2), unit].filter(Boolean).join(" ");
}

function poseLabel(i) {
  const poses = page.poses;
  const parts = [`pose ${count(poses.index[i])}`, `chainage ${station(poses.chainage[i])}`];
  for (const label of page.facts.page.labels) {
    parts.push(labelWords(label, poses.labels[label.key][i]));
  }
  return parts.filter(Boolean).join(", ");
}

/** Metres of the profile at shown pose i, below 0 inside the vehicle: null where none was found, undefined without profile. */
function distanceAt(i) {
  if (!page.poses.distance) return undefined;
  const d = page.poses.distance[i], { no_distance: none, distance_step: step } = page.facts.page;
  return d === none ? null : d * step;
}
