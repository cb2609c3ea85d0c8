// Sliders and buttons. Knows the page, not the GPU.

export const byId = (id) => document.getElementById(id);

/** A row: name, slider, value. */
export function slider(parent, name, least, most, value, changed) {
  const row = document.createElement('label');
  row.className = 'slider';
  const label = document.createElement('span');
  label.textContent = label.title = name;
  const input = Object.assign(document.createElement('input'),
    { type: 'range', min: least, max: most, step: 0.01, value, name });
  const output = document.createElement('output');
  // What is in force, which may lie beyond the slider's ends.
  const show = (number) => { output.textContent = number.toFixed(2); };
  input.addEventListener('input', () => { show(Number(input.value)); changed(Number(input.value)); });
  show(value);
  row.append(label, input, output);
  parent.append(row);
  return {
    row,
    name,
    set(to) { input.value = to; show(to); },
  };
}

export function options(select, names, values = names) {
  select.replaceChildren(...names.map((name, i) => new Option(name, values[i])));
}

export function filterRows(rows, text) {
  const wanted = text.trim().toLowerCase();
  for (const { row, name } of rows) row.hidden = !name.toLowerCase().includes(wanted);
}

/** Says what the colours of a view mean; null: nothing to say. */
export function showLegend(legend) {
  byId('legend').hidden = !legend;
  if (!legend) return;
  const [least, bar, most] = byId('legend').children;
  [least.textContent, bar.style.background, most.textContent] = [legend.least, legend.colours, legend.most];
}

/** Covers the page: nothing can be shown. */
export function fail(text) {
  const message = byId('message');
  message.textContent = text;
  message.hidden = false;
}

export function note(text) { byId('note').textContent = text; }

export function download(name, text) {
  const link = Object.assign(document.createElement('a'),
    { href: URL.createObjectURL(new Blob([text], { type: 'application/json' })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/** Calls `read` with the text of a chosen file; what it throws is shown. */
export function onFile(input, read) {
  input.addEventListener('change', async () => {
    const [file] = input.files;
    input.value = '';
    if (!file) return;
    try {
      read(await file.text(), file.name);
    } catch (error) {
      note(`${file.name}: ${error.message}`);
    }
  });
}
