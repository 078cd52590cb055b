// What no file can prove: numbers that a person compares with the vehicle and the route.

/** The most bodies that are described one by one. */
const kMostOnSite = 8;

const bearingWords = (degrees) => `${Math.round(degrees) % 360}°`;

/** "3.10 m behind the path's pose", of a place on the x axis. */
const aheadOf = (x, what) => x === 0 ? `at ${what}` : `${station(Math.abs(x))} ${x < 0 ? "behind" : "ahead of"} ${what}`;

/** How far the body reaches from its origin, which is the point of it that the path leads. */
function reachWords({ lo, hi }) {
  const reach = (value, positive, negative) => `${station(Math.abs(value))} ${value < 0 ? negative : positive}`;
  return `from its origin ${reach(hi[0], "ahead", "behind")}, ${reach(-lo[0], "behind", "ahead")}, ` +
         `${reach(hi[1], "left", "right")}, ${reach(-lo[1], "right", "left")}, ` +
         `${station(lo[2])} to ${station(hi[2])} high`;
}

/** The axles or pivots of a body, or where it is along the vehicle; empty where that is not known. */
function mountWords({ at, pivots, hitch, axle, coupled_at: coupled, towed_by: tower }) {
  if (pivots) {
    return `pivots ${station(Math.abs(pivots[0] - pivots[1]))} apart, ${aheadOf(pivots[0], "the path's pose")} and ` +
           aheadOf(pivots[1], "it");
  }
  if (hitch !== undefined) {
    return `axle ${station(hitch - axle)} behind the hitch, which is ` +
           aheadOf(coupled, tower ? `the origin of “${tower}”` : "the path's pose");
  }
  return at === undefined ? "" : `its origin is ${aheadOf(at, "the path's pose")}`;
}

function bodyOnSite(body, several) {
  const mount = mountWords(body);
  return make(several ? "li" : "div", {}, several && `${body.name}: `, make("strong", {}, `${sizeCell(body)} ${unitSymbol}`),
              !several && " (length × width × height)", mount && `, ${mount}`,
              make("div", { class: "note" }, reachWords(body)));
}

function vehicleOnSite(bodies) {
  if (bodies.length === 1) return bodyOnSite(bodies[0], false);
  const more = bodies.length - kMostOnSite;
  return make("div", {}, make("span", { class: "note" }, "length × width × height"),
              make("ul", { class: "bodies" }, bodies.slice(0, kMostOnSite).map((body) => bodyOnSite(body, true)),
                   more > 0 && make("li", {}, `and ${plural(more, "more body", "more bodies")}`)));
}

function placeOnSite(place) {
  const along = [`chainage ${station(place.chainage)}`, ...page.facts.page.labels
      .filter(({ key }) => place[key] !== undefined).map((label) => labelWords(label, place[label.key]))].join(", ");
  return make("div", {}, make("strong", {}, coordinates(place.position)), ` · ${along}`);
}

/** Where the vehicle drives to, which side is left, and whether its front is ahead. */
function directionOnSite({ first, last }) {
  if (first.bearing === null) return "the path has no direction on the map";
  const left = (first.bearing + 270) % 360;
  const turned = first.front_bearing === null ? 0
      : Math.abs((first.front_bearing - first.bearing + 540) % 360 - 180);
  return make("div", {}, make("strong", {}, `towards ${bearingWords(first.bearing)}`), " at the beginning",
              last.bearing !== null && ` and ${bearingWords(last.bearing)} at the end`,
              turned > 90 && make("strong", {}, ", backwards: its front points the other way"),
              make("div", { class: "note" }, "clockwise from the y axis, which is north on most maps; left is towards " +
                   `${bearingWords(left)} at the beginning`));
}

/** The numbers of the vehicle and its path. */
function vehicleBox() {
  const { bodies, first, last, bend } = page.facts.on_site;
  if (!first) return "";
  const path = page.facts.inputs.trajectory;
  return compareOnSite("the vehicle, its load and the place",
      [bodies.length > 1 ? "Bodies" : "Vehicle", vehicleOnSite(bodies)],
      ["Begins at", placeOnSite(first)],
      ["Ends at", placeOnSite(last)],
      ["Drives", directionOnSite(page.facts.on_site)],
      ["Tightest bend", bend ? `radius of about ${bend.radius < 100 ? station(bend.radius) : shortLength(+bend.radius.toPrecision(3))} ` +
                                      `at chainage ${placeWords(bend.chainage)}, measured over ${station(bend.over)} of path`
                                    : `none on ${station(path.length)} of path`]);
}
