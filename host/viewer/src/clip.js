// A clip: a table with commas, a column for each expression, a row for each frame (docs/command_line.md).

/** Frames of weights in the order of `names`. Throws an Error that names line and column. */
export function readClip(text, names) {
  const lines = text.replace(/^\ufeff/, '').split(/\r?\n/);
  const first = lines.findIndex((line) => line.trim() !== '');
  if (first < 0) throw new Error('the clip is empty');
  const header = lines[first].split(',').map((name) => name.trim());
  const columns = header.map((name, i) => {
    const index = names.indexOf(name);
    if (index < 0 && /^(frame|time)$/i.test(name)) return -1;  // unless an expression is called that
    if (index < 0) throw new Error(`line ${first + 1}, column ${i + 1}: the package has no expression "${name}"`);
    if (header.indexOf(name) !== i) throw new Error(`line ${first + 1}: "${name}" twice`);
    return index;
  });
  const frames = [];
  lines.forEach((line, number) => {
    if (number <= first || line.trim() === '') return;
    const fields = line.split(',');
    if (fields.length !== columns.length) {
      throw new Error(`line ${number + 1}: ${fields.length} fields, the header has ${columns.length}`);
    }
    const frame = new Float32Array(names.length);
    fields.forEach((field, i) => {
      if (columns[i] < 0) return;
      const weight = field.trim() === '' ? NaN : Number(field);
      if (!Number.isFinite(weight)) throw new Error(`line ${number + 1}, column ${i + 1}: "${field.trim()}" is no number`);
      frame[columns[i]] = weight;
    });
    frames.push(frame);
  });
  if (!frames.length) throw new Error('the clip has no frames');
  return frames;
}
