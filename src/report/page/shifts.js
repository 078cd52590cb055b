// What must move to pass: the least shifts that free the path and its conflicts.

const freedBy = new Map((page.facts.shifts?.list ?? []).map((row) => [row.conflict, row]));

/** Above all shifts where no shift of the range frees it, so that these come last. */
const freedRank = (conflict) => Math.abs(freedBy.get(conflict.id)?.shift ?? Infinity);

/** "0.12 left"; a dash where no shift that was tried frees it. */
function freedCell(conflict) {
  const shift = freedBy.get(conflict.id)?.shift ?? null;
  return shift === null ? "–" : `${+Math.abs(shift).toPrecision(6)} ${shift > 0 ? "left" : "right"}`;
}

/** How far was looked: "of up to 2 m", or the two ends of the range. */
function triedWords() {
  const { lateral_from: from, lateral_to: to } = page.facts.shifts;
  return -from === to ? `of up to ${shortLength(to)}`
      : `of up to ${shortLength(to)} to the left and ${shortLength(-from)} to the right`;
}

/** "0.12 m to the left". */
const shiftWords = (shift) => `${+Math.abs(shift).toPrecision(6)} ${unitSymbol} to the ${shift > 0 ? "left" : "right"}`;

const inDoubtWords = (codes) => `is known to free it, because the question is in doubt (${codes.join(", ")})`;

/** "0.12 m to the left between 14.9 and 15.8 m". */
function freedWords(conflict) {
  const { shift, least_distance: least, warned_of: codes } = freedBy.get(conflict.id);
  if (shift === null) return `no shift ${triedWords()} ${codes.length > 0 ? inDoubtWords(codes) : "frees it"}`;
  const [from, to] = [conflict.chainage_from, conflict.chainage_to].map((c) => c.toFixed(1));
  const where = from === to ? `at ${from} ${unitSymbol}` : `between ${from} and ${to} ${unitSymbol}`;
  return `${shiftWords(shift)} ${where}${least === null ? "" : `, which leaves ${metres(least)}`}`;
}

/** What the table of conflicts says of the shifts; nothing where they were not computed. */
function freedNote() {
  const { shifts } = page.facts;
  if (!shifts) return "";
  const freed = shifts.list.filter((row) => row.shift !== null).length;
  const { shift, warned_of: codes } = shifts.path;
  const path = shift === 0 ? " The path is free as it is."
      : shift !== null ? ` A shift of the whole path by ${shiftWords(shift)} frees all of it.`
      : ` No shift ${triedWords()} ${codes.length > 0 ? inDoubtWords(codes) : "frees the whole path"}.`;
  if (shifts.list.length === 0) return path;
  return `${path} Where the table says what frees a conflict, the vehicle touches nothing at all between its first ` +
      `and its last touch if it is shifted by so much there: ${count(freed)} of ` +
      `${plural(shifts.list.length, "conflict")} can be freed by a shift ${triedWords()}, tried in steps of ` +
      `${shortLength(shifts.step)}. Places that were not scanned count as free.`;
}
