// A clip: a table with commas, a column for each expression, a row for each frame (docs/command_line.md). What
// `facezip blend --animation` takes is taken, what it refuses is refused.

import { isNoShape, matchNames } from './shape_names.js';

const kLargest = 1e6;
const kUsual = 2;  // people write per cent

// Not String.trim(): it knows more blanks.
const trimmed = (text) => text.replace(/^[ \t\r]+|[ \t\r]+$/g, '');

/** Fields of one line, blanks and one pair of double quotes taken off. */
function splitLine(line) {
  return line.split(',').map((field) => trimmed(field).replace(/^"(.*)"$/s, '$1'));
}

/** The number that all of `text` says in decimal, as 32-bit floats have it; NaN if it says none. */
function parseNumber(text) {
  const decimal = /^\+?-?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(trimmed(text));
  return decimal ? Math.fround(trimmed(text).replace(/^\+/, '')) : NaN;
}

/** The header of a table: names, what each column drives, and the column of Live Link Face's count of shapes. */
function readHeader(line, number, names) {
  const header = splitLine(line);
  const drives = matchNames(header, names);
  drives.forEach((match, i) => {
    if (match.repeats !== undefined) throw new Error(`line ${number}: "${header[match.repeats]}" and "${header[i]}" are one`);
  });
  if (!drives.some((match) => match.length)) {
    const [unknown = ''] = header.filter((name) => !isNoShape(name));
    throw new Error(`line ${number}: no column has the name of an expression, nor has "${unknown}"`);
  }
  return { header, drives, count: header.findIndex((name, i) => !drives[i].length && /^blendshapecount$/i.test(name)) };
}

/** Frames of weights in the order of `names`, and notes for whom they belong to. Throws an Error that names line and column. */
export function readClip(text, names) {
  const lines = text.replace(/^\ufeff/, '').split('\n');
  const first = lines.findIndex((line) => trimmed(line) !== '');
  if (first < 0) throw new Error('the clip is empty');
  const { header, drives, count } = readHeader(lines[first], first + 1, names);
  const frames = [];
  let largest = 0;
  lines.forEach((line, number) => {
    if (number <= first || trimmed(line) === '') return;
    const fields = splitLine(line);
    const frame = new Float32Array(names.length);
    frames.push(frame);
    if (fields[count] === '0') {  // no face was seen
      if (frames.length > 1) frame.set(frames[frames.length - 2]);
      return;
    }
    if (fields.length !== header.length) {
      throw new Error(`line ${number + 1}: ${fields.length} fields, the header has ${header.length}`);
    }
    fields.forEach((field, i) => {
      if (!drives[i].length) return;
      const weight = parseNumber(field);
      if (!(Math.abs(weight) <= kLargest)) {
        throw new Error(`line ${number + 1}, column ${i + 1}: "${field}" is not a number from -${kLargest} to ${kLargest}`);
      }
      for (const [n, share] of drives[i]) frame[n] += share * weight;
      if (Math.abs(weight) > Math.abs(largest)) largest = weight;
    });
  });
  if (!frames.length) throw new Error('the clip has no frames');
  const notes = [];
  const skipped = header.filter((name, i) => !drives[i].length && name !== '' && !isNoShape(name));
  if (skipped.length) notes.push(`no expression is called ${skipped.join(', ')}`);
  if (Math.abs(largest) > kUsual) notes.push(`weights up to ${largest}: 1 is the whole expression`);
  return { frames, notes };
}
