// What the pages of a result and of a section share: the head, the answer, tables, and how a page starts.

const capital = (text) => text ? text[0].toUpperCase() + text.slice(1) : text;
/** With a capital letter and a sign at the end, which a question has already. */
const asSentence = (text) => capital(text) + (/[.?!]$/.test(text) ? "" : ".");

const joined = (words) => words.length < 2 ? words.join("")
    : `${words.slice(0, -1).join(", ")} and ${words.at(-1)}`;

/** The scans that were made into a store, and when; the first of them by name. */
function scanWords({ files, names, first_date: first, last_date: last }) {
  const more = files - names.length, all = joined(more > 0 ? [...names, `${count(more)} more`] : names);
  const days = first === null ? `, without a date of ${files === 1 ? "its" : "their"} own`
      : ` of ${first}${last === first ? "" : ` to ${last}`}`;
  return `${plural(files, "scan")} (${all})${days}`;
}

/** A link to each part of the page, the texts of the head and the foot, and the button that prints. */
function buildHead() {
  const { facts } = page;
  byId("print-page").before(...[...document.querySelectorAll("main > section[data-part]")].flatMap((part) =>
      [make("a", { href: `#${part.id}` }, part.dataset.part), "\n"]));
  byId("print-page").addEventListener("click", () => window.print());
  byId("made").textContent = [facts.date && `Made ${facts.date}`, `by Clearway ${facts.clearway}`].filter(Boolean).join(" ");
  byId("about").append(...["project", "client", "author"].filter((key) => facts[key]).map((key) =>
      make("span", {}, `${capital(key)}: `, make("strong", {}, facts[key]))));
  byId("footer").textContent = "All data of this page is in this one file. Lengths are in the unit of the scans " +
      `(${unitSymbol}). Chainage counts from the first pose along the path.`;
  byId("loading").remove();
}

/** Removes a part of the page that has nothing to show, with its link. */
function removePart(id) {
  byId(id)?.remove();
  document.querySelector(`nav a[href="#${id}"]`)?.remove();
}

/** The answer. kind: clear, conflict, undecided, or plain for an answer without a sign. lines: elements below the word. */
function answerBanner({ kind, word, lines }) {
  const warned = kind === "clear" && word.endsWith("with warnings");
  const sign = warned ? warningSymbol() : kind !== "plain" && verdictSymbol(kind);
  return make("div", { class: `banner ${warned ? "warned" : kind}` }, sign,
      make("div", { class: "words" }, make("h2", { id: "verdict-word" }, word), lines));
}

/** "See 2 warnings below." lead: its first words. */
const seeWarnings = (lead, warnings) => warnings.length > 0 &&
    make("p", { class: "but" }, `${lead} ${plural(warnings.length, "warning")} below.`);

const warningsList = (texts) => texts.length === 0 ? ""
    : make("ul", { class: "warnings", "aria-label": "Warnings" }, texts.map((text) => make("li", {}, text)));

/** A table of names and values. rows: [name, ...value]; those that are left out are falsy. */
const factsTable = (...rows) => make("table", { class: "facts" }, make("tbody", {}, rows.filter(Boolean).map(([name, ...value]) =>
    make("tr", {}, make("th", { scope: "row" }, name), make("td", {}, ...value)))));

/** Numbers that a person compares with the load and the place, because nothing in the files shows whether they are right. */
const compareOnSite = (what, ...rows) => make("div", { class: "basis", id: "on-site" },
    make("h3", {}, "Check these on site"),
    make("p", { class: "note" }, `No file shows whether these are right. Compare them with ${what}.`),
    factsTable(...rows));

/** Attributes of a row that a click, Enter or the space bar chooses. */
const chosenBy = (choose) => ({ tabindex: 0, onclick: choose, onkeydown: (event) => {
  if (event.key !== "Enter" && event.key !== " ") return;
  event.preventDefault();
  choose();
} });

/** Columns of a table. list: of each its title, what makes its cell of an item, a text or an element, and "number" or "text". */
const columnsOf = (list) => list.filter(Boolean).map(([title, cell, kind = null]) => ({ title, cell, kind }));

const cellsOf = (columns, item) => columns.map(({ cell, kind }) => make("td", { class: kind }, cell(item)));

/** A box that scrolls. An edge fades where columns or rows lie beyond it, so that no number seems to end there. */
function scrollBox(kind, ...content) {
  const box = make("div", { class: `scroll ${kind}` }, ...content);
  const mark = () => {
    box.classList.toggle("wider", box.scrollLeft + box.clientWidth < box.scrollWidth - 1);
    box.classList.toggle("longer", box.scrollTop + box.clientHeight < box.scrollHeight - 1);
  };
  box.addEventListener("scroll", mark);
  new ResizeObserver(mark).observe(box);
  return box;
}

/** A table with a row of titles. rows: elements. */
const listTable = (label, columns, rows) => make("table", { class: "list", "aria-label": label },
    make("thead", {}, make("tr", {}, columns.map(({ title, heading = title, kind }) =>
        make("th", { scope: "col", class: kind === "number" ? kind : null }, heading)))),
    make("tbody", {}, rows));

/** The same with a row for each item, in a box that scrolls. how(item): attributes of its row. */
const itemTable = (label, columns, items, how = () => ({}), kind = "") => scrollBox(kind,
    listTable(label, columns, items.map((item) => make("tr", how(item), cellsOf(columns, item)))));

/** Reads what the page holds, and then builds its parts in this order. */
async function fillPage(read, builds) {
  if (typeof DecompressionStream === "undefined") {
    throw new Error("This browser is too old for this page: it needs DecompressionStream " +
                    "(Chromium 80, Firefox 113, Safari 16.4, or later).");
  }
  await read();
  for (const build of [buildHead, ...builds]) build();
  document.body.dataset.ready = "true";
}

function startPage(read, builds) {
  fillPage(read, builds).catch((error) => {
    const holder = byId("loading") ?? byId("verdict-body");
    holder.className = "problem";
    holder.textContent = error.message;
    document.body.dataset.ready = "failed";
    console.error(error);
  });
}
