// The page of a campaign: what its runs find, a table of vehicles and routes for each radius, and lists of what to look at.

const words = page.facts.words;
const runs = page.facts.runs.map((run, i) => ({ ...run, ...words.runs[i], name: `${run.vehicle}/${run.route}/${run.radius}` }));

const linked = ({ page: link }, content) => link ? make("a", { href: link }, content) : content;
const signOf = (sign) => make("span", { class: "sign", "aria-hidden": "true" }, sign);

/** Adds a part to the page. */
const addPart = (title, ...content) => document.querySelector("main").append(
    make("section", { id: title.toLowerCase().replaceAll(" ", "-"), "data-part": title }, make("h2", {}, title), ...content));

/** A list of runs; nothing where it is empty. */
function addList(title, columns, items) {
  if (items.length > 0) addPart(title, itemTable(title, columnsOf(columns), items, undefined, "tall"));
}

function addSummary() {
  byId("verdict-body").append(make("p", { class: "answer" }, words.answer),
      make("ul", { class: "outcomes" }, words.outcomes.map(({ name, sign, word, count: runsOf }) =>
          make("li", { class: name }, signOf(sign), " ", make("b", {}, count(runsOf)), ` ${word}`))),
      make("details", { class: "note" }, make("summary", {}, "What the cells say"), make("ul", {},
          [...words.outcomes.map(({ meaning }) => meaning),
           "the verdict, the least distance that is known, how many conflicts are listed, the side and the chainage of the least " +
               "distance or of the first place; a link to the report of the run"].map((text) => make("li", {}, text)))));
}

function cellOf(run) {
  const { outcome, vehicle, route, details, sign, word, least, place, caveats } = run;
  const content = [signOf(sign), " ", make("span", { class: "word" }, word), least && make("br"), least && make("b", {}, least),
                   ...[place, caveats].filter(Boolean).map((text) => make("small", {}, text))];
  return make("td", { class: outcome, title: `${vehicle} on ${route}: ${details}` }, linked(run, content.filter(Boolean)));
}

/** Each value once, in the order in which it comes. */
const distinct = (values) => [...new Set(values)];

/** The table of vehicles and routes for a radius. */
function addTable(radius) {
  const title = words.radii[radius], routes = distinct(runs.map(({ route }) => route));
  const runAt = new Map(runs.filter((run) => run.radius === radius).map((run) => [`${run.vehicle}/${run.route}`, run]));
  const heads = routes.map((route) => make("th", { scope: "col" }, route,
      make("small", {}, runs.find((run) => run.route === route).environment)));
  const rows = distinct(runs.map(({ vehicle }) => vehicle)).map((vehicle) => make("tr", {}, make("th", { scope: "row" }, vehicle),
      routes.map((route) => cellOf(runAt.get(`${vehicle}/${route}`)))));
  addPart(title, make("div", { class: "scroll cells", role: "region", tabindex: 0, "aria-label": title },
      make("table", { class: routes.length > 10 ? "matrix many" : "matrix" },
           make("thead", {}, make("tr", {}, make("th", { scope: "col" }, "vehicle"), heads)), make("tbody", {}, rows))));
}

/** Links to runs; only to the first ones of many. */
const linksTo = (some) => [...some.slice(0, 12).flatMap((run, i) => [i > 0 && ", ", linked(run, run.name)]),
                           some.length > 12 && ` and ${count(some.length - 12)} more`];

/** Runs by what is true of them, in the order of the keys. keysOf(run): [key, text] of each. */
function groupedBy(keysOf) {
  const groups = new Map();
  for (const run of runs) {
    for (const [key, text] of keysOf(run)) {
      if (!groups.has(key)) groups.set(key, { key, text, runs: new Set() });
      groups.get(key).runs.add(run);
    }
  }
  return [...groups.values()].sort((a, b) => a.key < b.key ? -1 : 1).map((group) => ({ ...group, runs: [...group.runs] }));
}

function addLists() {
  const counted = ["runs", (group) => count(group.runs.length), "number"], where = ["in", (group) => linksTo(group.runs), "text"];
  const key = ({ key }) => key;
  addList("Warnings", [counted, ["warning", key], ["what the first of them says", ({ text }) => text, "text"], where],
          groupedBy(({ warnings = [], warning_texts: texts }) => warnings.map((code, i) => [code, texts[i]])));
  addList("Left out of the search", [counted, ["points", key], where],
          groupedBy(({ ignored_words: ignored }) => ignored ? [[ignored]] : []));
  addList("Failed", [["task", ({ task }) => String(task), "number"], ["run", (run) => linked(run, run.name)],
                     ["what happened", ({ details }) => details, "text"]], runs.filter(({ outcome }) => outcome === "failed"));
  if (words.unfinished === "") return;
  addPart("Not done",
          make("p", {}, `Tasks ${words.unfinished}. `, make("code", {}, "clearway campaign run DIR --all"), " goes on with them."),
          make("ul", {}, runs.filter(({ changed }) => changed).map(({ name, changed }) =>
              make("li", {}, `${name}: ${changed}, so its verdict would be of an earlier file`))));
}

async function addParts() {
  addSummary();
  distinct(runs.map(({ radius }) => radius)).forEach(addTable);
  addLists();
}

const buildFoot = () => { byId("footer").textContent = "The links lead to reports and files in the folder of this page."; };

startPage(addParts, [buildFoot]);
