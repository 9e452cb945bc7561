// SPDX-License-Identifier: GPL-3.0-or-later
//
// Gravity and the parameters of models, as numbers to change.

function number(value, change) {
  const input = document.createElement('input');
  input.type = 'number';
  input.step = 'any';
  input.value = Number(value.toPrecision(6));
  input.dataset.control = '';
  input.onchange = () => change(Number(input.value));
  return input;
}

function row(name, doc, unit, inputs) {
  const label = document.createElement('label');
  label.title = doc;
  label.append(name, ...inputs, unit === '1' ? '' : unit);
  return label;
}

// Shows `values` in `box`; apply(event) sends a change.
export function show_values(box, values, apply) {
  const gravity = values.gravity.map((value, axis) => number(value, (changed) => apply(
    { gravity: values.gravity.map((other, i) => (i === axis ? changed : other)) })));
  box.replaceChildren(row('gravity', 'acceleration of the whole body', 'm/s²', gravity));
  for (const model of values.models) {
    const title = document.createElement('div');
    title.textContent = model.name;
    box.append(title, ...model.parameters.map((p) => row(p.name, p.doc, p.unit, [number(p.value, (changed) => apply(
      { parameters: { model: model.name, values: { [p.name]: changed } } }))])));
  }
}
