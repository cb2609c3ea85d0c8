// A clip: a table with commas, a column for each expression, a row for each frame (docs/command_line.md). What
// `facezip blend --animation` takes is taken, what it refuses is refused.

const kLargest = 1e6;

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

/** Frames of weights in the order of `names`. Throws an Error that names line and column. */
export function readClip(text, names) {
  const lines = text.replace(/^\ufeff/, '').split('\n');
  const first = lines.findIndex((line) => trimmed(line) !== '');
  if (first < 0) throw new Error('the clip is empty');
  const header = splitLine(lines[first]);
  const columns = header.map((name, i) => {
    const index = names.indexOf(name);
    if (index < 0 && /^(frame|time)$/i.test(name)) return -1;  // unless an expression is called that
    if (index < 0) throw new Error(`line ${first + 1}, column ${i + 1}: the package has no expression "${name}"`);
    if (header.indexOf(name) !== i) throw new Error(`line ${first + 1}: "${name}" twice`);
    return index;
  });
  const frames = [];
  lines.forEach((line, number) => {
    if (number <= first || trimmed(line) === '') return;
    const fields = splitLine(line);
    if (fields.length !== columns.length) {
      throw new Error(`line ${number + 1}: ${fields.length} fields, the header has ${columns.length}`);
    }
    const frame = new Float32Array(names.length);
    fields.forEach((field, i) => {
      if (columns[i] < 0) return;
      const weight = parseNumber(field);
      if (!(Math.abs(weight) <= kLargest)) {
        throw new Error(`line ${number + 1}, column ${i + 1}: "${field}" is not a number from -${kLargest} to ${kLargest}`);
      }
      frame[columns[i]] = weight;
    });
    frames.push(frame);
  });
  if (!frames.length) throw new Error('the clip has no frames');
  return frames;
}
