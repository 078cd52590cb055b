// Signs beside a verdict.

const symbolOf = (...shapes) => make("svg", { viewBox: "0 0 64 64", class: "sign", "aria-hidden": "true" }, ...shapes);

const warningSymbol = () => symbolOf(make("polygon", { points: "32,4 62,58 2,58", fill: "currentColor" }),
                                 make("path", { d: "M32 22 V41 M32 47 V52", stroke: "#fff", "stroke-width": 6 }));

function verdictSymbol(verdict) {
  if (verdict === "undecided") return warningSymbol();
  const line = { stroke: "#fff", "stroke-width": 7, "stroke-linecap": "round" };
  return verdict === "clear"
      ? symbolOf(make("circle", { cx: 32, cy: 32, r: 30, fill: "currentColor" }), make("path", { d: "M17 33 L28 44 L48 21", fill: "none", ...line }))
      : symbolOf(make("polygon", { points: "20,2 44,2 62,20 62,44 44,62 20,62 2,44 2,20", fill: "currentColor" }),
             make("path", { d: "M21 21 L43 43 M43 21 L21 43", ...line }));
}
