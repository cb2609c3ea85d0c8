// One blendshape under several names, as `facezip blend` matches them (host/src/blend/shape_names.cpp).
import table from '../../data/shape_names.json';
import { composed } from './composed.js';

// ASCII alone, as in C.
const lowered = (name) => name.replace(/[A-Z]/g, (c) => c.toLowerCase());

const shapes = new Map(table.shapes.flatMap((row) => row.map((name) => [lowered(name), lowered(row[0])])));
const shapeOf = (name) => shapes.get(lowered(name)) ?? lowered(name);
const groups = table.groups.map(({ names, of }) => ({ names: names.map(lowered), of: of.map(shapeOf) }));
for (const { names } of groups) {
  for (const name of names) if (!shapes.has(name)) shapes.set(name, names[0]);
}
const noShapes = new Set(table.no_shapes.map(lowered));

/** Does a column of a clip hold something else than weights, as face trackers write it: time, turns of the head? */
export const isNoShape = (name) => noShapes.has(lowered(name));

/**
 * What each of `given` drives among `names`: a list of [index, share], empty where nothing is called so; or the index of
 * an earlier one that says the same, as { repeats }.
 */
export function matchNames(given, names) {
  const byShape = new Map();
  names.forEach((name, n) => byShape.set(shapeOf(name), byShape.has(shapeOf(name)) ? -1 : n));
  const named = (shape) => byShape.get(shape) ?? -1;
  const driven = new Set();
  const matches = given.map(() => []);
  const isOpen = (match) => Array.isArray(match) && match.length === 0;

  const driveOne = (find) => {
    const drivers = new Map();  // of this round
    given.forEach((name, g) => {
      const n = isOpen(matches[g]) ? find(composed(name)) : -1;
      if (n < 0 || driven.has(n)) return;
      matches[g] = drivers.has(n) ? { repeats: drivers.get(n) } : [[n, 1]];
      if (!drivers.has(n)) drivers.set(n, g);
    });
    for (const n of drivers.keys()) driven.add(n);
  };
  driveOne((name) => names.indexOf(name));
  driveOne((name) => named(shapeOf(name)));

  const parts = new Set();  // expressions of several shapes, and shapes that drive them already
  given.forEach((name, g) => {
    if (!isOpen(matches[g])) return;
    const lower = lowered(composed(name));
    const whole = groups.filter((group) => group.names.includes(lower));
    for (const shape of whole.flatMap((group) => group.of)) {
      const n = named(shape);
      if (n < 0 || driven.has(n)) continue;
      matches[g].push([n, 1]);
      driven.add(n);
    }
    if (whole.length) return;
    const shape = shapeOf(lower);
    names.forEach((expression, n) => {
      if (driven.has(n)) return;
      for (const group of groups) {
        const part = `${n} ${shape}`;
        if (!group.names.includes(lowered(expression)) || !group.of.includes(shape) || parts.has(part)) continue;
        parts.add(part);
        matches[g].push([n, 1 / group.of.length]);
      }
    });
  });
  return matches;
}
