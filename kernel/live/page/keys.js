// SPDX-License-Identifier: GPL-3.0-or-later
//
// What keys do, and the table that says it.

const name_of = (event) => (event.key === ' ' ? 'space' : event.key.toLowerCase());
const is_for_itself = (target, key) => target.matches('select, input[type=number]') ||
  (key === 'space' && target.matches('button, input[type=checkbox]'));

// `actions`: a list of {key, does, act}, with keys in small letters.
export function follow_keys(actions, table) {
  for (const { key, does } of actions) {
    const row = table.insertRow(), name = document.createElement('kbd');
    name.textContent = key.length === 1 ? key.toUpperCase() : key;
    row.insertCell().append(name);
    row.insertCell().textContent = does;
  }
  document.addEventListener('keydown', (event) => {
    const key = name_of(event);
    if (event.ctrlKey || event.altKey || event.metaKey || is_for_itself(event.target, key)) return;
    const action = actions.find((one) => one.key === key);
    if (!action) return;
    if (key !== 'escape') event.preventDefault();  // which closes dialogs, too
    action.act();
  });
  // What the mouse has chosen shall not keep the keys.
  document.addEventListener('change', (event) => event.target.blur());
  document.addEventListener('click', (event) => {
    if (event.detail > 0 && event.target.matches('button')) event.target.blur();
  });
}
