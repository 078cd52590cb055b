// Charts along the path, drawn as SVG: where values lie, axes, shaded stretches, numbered bars, scales and keys.

/** Values across from `from` to `to` and up from `low` to `high`; in pixels its size, and what is left around its field. */
class Chart {
  constructor(bottom) {
    Object.assign(this, { from: 0, to: 1, low: 0, high: 1, width: 1000, height: 300, left: 62, right: 16, top: 26, bottom, crowded: 0,
                          title: `chainage (${unitSymbol})` });
  }

  get wide() { return this.width - this.left - this.right; }
  get tall() { return this.height - this.top - this.bottom; }
  get base() { return this.height - this.bottom; }

  x(value) { return this.left + this.wide * (value - this.from) / (this.to - this.from); }
  y(value) { return this.top + this.tall * (this.high - value) / (this.high - this.low); }
  /** The same within the field. */
  inside(value) { return clamp(this.x(value), this.left, this.left + this.wide); }

  /** Both values under the pointer. */
  at(svg, event) {
    const box = svg.getBoundingClientRect();
    const x = (event.clientX - box.left) * this.width / box.width, y = (event.clientY - box.top) * this.height / box.height;
    return [this.from + (x - this.left) / this.wide * (this.to - this.from),
            this.high - (y - this.top) / this.tall * (this.high - this.low)];
  }

  /** The field, as the attributes of a rectangle. */
  get field() { return { x: this.left, y: this.top, width: this.wide, height: this.tall }; }
  /** A line at this value from one side of the field to the other. */
  level(value, kind) {
    return make("line", { x1: this.left, x2: this.left + this.wide, y1: this.y(value), y2: this.y(value), class: kind });
  }

  /** Round values of both axes, `most` of them upwards, with lines through the field or, where marked, with marks beside it. */
  axes(most, marked, words = minus) {
    const out = [], kind = marked ? "tick" : "grid", { left, top, base } = this, right = left + this.wide;
    for (const value of ticks(this.low, this.high, most)) {
      const y = this.y(value), [x1, x2] = marked ? [left - 5, left] : [left, right];
      out.push(make("line", { x1, x2, y1: y, y2: y, class: kind }),
               make("text", { x: left - 8, y: y + 4, class: "end" }, words(value)));
    }
    for (const value of ticks(Math.min(this.from, this.to), Math.max(this.from, this.to), this.width / 90)) {
      const x = this.x(value), [y1, y2] = marked ? [base, base + 5] : [top, base];
      out.push(make("line", { x1: x, x2: x, y1, y2, class: kind }),
               make("text", { x, y: base + 17, class: "middle" }, words(value)));
    }
    out.push(this.title && make("text", { x: right, y: this.height - 4, class: "end" }, this.title));
    return out;
  }

  /**
   * Stretches that are in sight, shaded from top to bottom, with words where there is room. stretches: {from, to, kind (of the
   * rectangle, and its pattern), words, title}. apart: the least distance of words in pixels.
   */
  shaded(stretches, apart = 0) {
    let free = -Infinity;
    return stretches.filter(({ from, to }) => to >= this.from && from <= this.to).flatMap(({ from, to, kind, words, title }) => {
      const x = this.inside(from), width = Math.max(2, this.inside(to) - x), middle = x + width / 2, y = this.top + this.tall / 2;
      const room = width > 16 && middle - free > apart;
      if (room) free = middle;
      return [make("rect", { ...this.field, x, width, class: kind, fill: `url(#${kind})` }, title && make("title", {}, title)),
              room && make("text", { x: middle, y: y + 4, class: "middle strong halo",
                                     transform: width > 84 ? null : `rotate(-90 ${middle} ${y})` }, words)];
    });
  }

  /** Bars below the axis, numbered where there is room. items: {from, to, label, title, chosen, choose, look(x, y, width)}. */
  bars(items) {
    const y = this.base + 24, bars = items.filter(({ from, to }) => to >= this.from && from <= this.to).map((item) => {
      const x = this.inside(item.from), width = Math.max(3, this.inside(item.to) - x);
      return { ...item, x, width, middle: x + width / 2 };
    });
    const taken = bars.find((bar) => bar.chosen)?.middle ?? -Infinity;
    let free = -Infinity;
    this.crowded = 0;
    return bars.map(({ x, width, middle, label, title, chosen, choose, look }) => {
      const room = 8 * label.length + 10, numbered = chosen || (middle - free > room && Math.abs(middle - taken) > room);
      if (numbered) free = middle; else ++this.crowded;
      return make("g", { class: chosen ? "mark chosen" : "mark", onclick: (event) => { event.stopPropagation(); choose(); } },
                  make("rect", look(x, y, width)), numbered && make("text", { x: middle, y: y + 21, class: "middle" }, label),
                  title && make("title", {}, title));
    });
  }

  svg(attributes, content) {
    const { width, height } = this;
    return make("svg", { viewBox: `0 0 ${width} ${height}`, width, height, ...attributes }, ...content);
  }

  /** Puts the chart into its place, with elements below it. It keeps the focus. */
  show(holder, label, content, ...below) {
    const focused = holder.contains(document.activeElement);
    const svg = this.svg({ tabindex: 0, role: "application", "aria-label": label }, content);
    holder.replaceChildren(svg, ...below, crowdedBars(this.crowded));
    if (focused) svg.focus();
    return svg;
  }
}

/** How many bars below an axis have no room for their number; nothing where all have it. */
const crowdedBars = (bars) => bars === 0 ? "" : make("p", { class: "note" },
    `${plural(bars, "bar")} below the axis ${bars === 1 ? "has" : "have"} no room for a number; the table has all of them.`);

const minus = (value) => String(value).replace("-", "−");

/** Values at round steps from a to b. */
function ticks(a, b, most) {
  const step = [1, 2, 5, 10].map((f) => f * 10 ** Math.floor(Math.log10((b - a) / most)))
      .find((s) => (b - a) / s <= most) ?? (b - a);
  const out = [];
  for (let k = Math.ceil(a / step - 1e-9); k * step <= b + 1e-9 * step; ++k) {
    out.push(+(k * step).toPrecision(12));
  }
  return out;
}

/** A pattern of parallel lines. lines: of each its colour and width, the upper one last. */
const hatching = (id, size, angle, ground, ...lines) => make("pattern",
    { id, width: size, height: size, patternUnits: "userSpaceOnUse", patternTransform: `rotate(${angle})` },
    make("rect", { width: size, height: size, fill: ground }),
    lines.map(([stroke, width]) => make("line", { x1: 0, y1: 0, x2: 0, y2: size, stroke, "stroke-width": width })));

/** A sample of a pattern, for a legend. */
const swatch = (id, stroke) => make("svg", { width: 26, height: 14, class: "swatch", "aria-hidden": "true" },
    make("rect", { width: 26, height: 14, fill: `url(#${id})`, stroke }));

/** From white to dark, so that grey says the same. */
const shadeOf = (share) => mix([255, 255, 255], [59, 7, 100], share).map(Math.round);

/** Five steps of a scale. darkness, words: of each share. */
const shadeScale = (darkness, words) => make("div", { class: "scale" }, [0, 0.25, 0.5, 0.75, 1].map((share) =>
    make("span", { style: `background:rgb(${shadeOf(darkness(share)).join(",")});color:${darkness(share) > 0.5 ? "#fff" : "#111827"}` },
         words(share))));

/** What keys do. actions(event): functions by the names of keys. */
const onKeys = (element, actions) => element.addEventListener("keydown", (event) => {
  const act = actions(event)[event.key];
  if (!act) return;
  event.preventDefault();
  act();
});

/** What paints in the next frame, however often it is called before. */
function inNextFrame(paint) {
  let due = false;
  return () => {
    if (!due) requestAnimationFrame(() => { due = false; paint(); });
    due = true;
  };
}

/** The keys that zoom, and the one that shows all. */
const zoomKeys = (closer, farther, all) => ({ "+": closer, "=": closer, "-": farther, "0": all });
